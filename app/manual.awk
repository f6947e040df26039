# Makes of what a program says with --describe its manual page (-v page=man) or its completion for bash (-v page=bash), so that
# neither can say what the program does not. -v version=V. Called by install.sh.
BEGIN { FS = "\t" }

$1 == "program" { program = $2; summary = $3; details = $4 }
$1 == "environment" { variables[++variable_count] = $2; variable_text[variable_count] = $3 }
$1 == "verb" { verbs[++verb_count] = $2; verb_summary[$2] = $3; verb_details[$2] = $4 }
$1 == "option" {
    verb = verb_count ? verbs[verb_count] : ""
    count[verb]++
    name[verb, count[verb]] = $2
    argument[verb, count[verb]] = $3
    required[verb, count[verb]] = $4
    text[verb, count[verb]] = $5
}

END {
    if (page == "man")
        man()
    else
        bash()
}

# ---- roff ----

function roff(s) {
    gsub(/\\n/, "\n", s)
    gsub(/\\/, "\\e", s)
    gsub(/-/, "\\-", s)
    gsub(/(^|\n)['.]/, "\\\\\\&&", s)
    return s
}

function usage(verb,    i) {
    printf ".B %s%s\n", roff(program), verb == "" ? "" : " " verb
    for (i = 1; i <= count[verb]; i++)
        if (required[verb, i] != "")
            printf "%s\n", roff(name[verb, i] (argument[verb, i] == "" ? "" : " " argument[verb, i]))
        else if (name[verb, i] !~ /^-/)
            printf "[%s]\n", roff(name[verb, i])
    print "[options]"
}

function options(verb,    i) {
    for (i = 1; i <= count[verb]; i++) {
        printf ".TP\n.BI \"%s\"", roff(name[verb, i])
        if (argument[verb, i] != "")
            printf " \" %s\"", roff(argument[verb, i])
        printf "\n%s\n", roff(text[verb, i])
    }
}

function man(    i, verb) {
    printf ".TH %s 1 \"\" \"diptych %s\" \"User Commands\"\n", toupper(roff(program)), version
    printf ".SH NAME\n%s \\- %s\n.SH SYNOPSIS\n", roff(program), roff(summary)
    if (verb_count)
        printf ".B %s\n.I VERB\n[options]\n.SH VERBS\n", roff(program)
    else
        usage("")
    for (i = 1; i <= verb_count; i++) {
        verb = verbs[i]
        printf ".SS %s\n", verb
        usage(verb)
        printf ".PP\n%s.\n%s\n", roff(toupper(substr(verb_summary[verb], 1, 1)) substr(verb_summary[verb], 2)),
            roff(verb_details[verb])
        options(verb)
    }
    if (!verb_count) {
        print ".SH OPTIONS"
        options("")
        printf ".SH DESCRIPTION\n%s\n", roff(details)
    }
    if (variable_count)
        print ".SH ENVIRONMENT"
    for (i = 1; i <= variable_count; i++)
        printf ".TP\n.B %s\n%s\n", variables[i], roff(variable_text[i])
    printf ".SH SEE ALSO\n.BR %s (1)\n", verb_count ? "diptych\\-gen" : "diptych"
}

# ---- bash ----

# What completes an argument, by its name: alternatives, files, folders; or nothing.
function completes(option, what) {
    if (option == "--backend" && what ~ /^(NAME|LIST)$/)
        return "words gl vk osmesa zink gl+glsl"
    if (what == "NAME|both")
        return "words gl vk both"
    if (what ~ /^[a-z0-9|]+$/) {
        gsub(/\|/, " ", what)
        return "words " what
    }
    if (what ~ /^DIR/)
        return "folders"
    return what ~ /^(FILE|SPEC)/ ? "files" : ""
}

function cases(verb,    i, k, kind, list, kinds) {
    for (i = 1; i <= count[verb]; i++)
        if (argument[verb, i] != "") {
            kind = completes(name[verb, i], argument[verb, i])
            list[kind] = list[kind] (list[kind] == "" ? "" : " | ") name[verb, i]
            if (index(kinds, kind "\n") == 0)
                kinds = kinds kind "\n"
        }
    for (k = split(kinds, kind_list, "\n") - 1; k >= 1; k--) {
        kind = kind_list[k]
        printf "        %s)", list[kind]
        if (kind == "files")
            print " mapfile -t COMPREPLY < <(compgen -f -- \"$word\"); compopt -o filenames 2>/dev/null; return 0 ;;"
        else if (kind == "folders")
            print " mapfile -t COMPREPLY < <(compgen -d -- \"$word\"); compopt -o filenames 2>/dev/null; return 0 ;;"
        else if (kind == "")
            print " return ;;"
        else
            printf " mapfile -t COMPREPLY < <(compgen -W '%s' -- \"$word\"); return ;;\n", substr(kind, 7)
    }
}

function flags(verb,    i, all, alone) {
    for (i = 1; i <= count[verb]; i++)
        if (name[verb, i] ~ /^-/)
            all = all (all == "" ? "" : " ") name[verb, i]
        else
            alone = name[verb, i]
    print "        esac"
    if (alone == "VERB") {
        all = all all_verbs
    } else if (alone != "") {
        print "        if [[ $word != -* ]]; then"
        print "            mapfile -t COMPREPLY < <(compgen -f -- \"$word\")"
        print "            compopt -o filenames 2>/dev/null"
        print "            return 0\n        fi"
    }
    printf "        mapfile -t COMPREPLY < <(compgen -W '%s' -- \"$word\")\n", all
}

function bash(    i, f) {
    f = "_" program
    gsub(/-/, "_", f)
    printf "# Completion for %s, as version %s describes itself.\n", program, version
    printf "%s() {\n    local word=${COMP_WORDS[COMP_CWORD]} last=${COMP_WORDS[COMP_CWORD - 1]}\n    COMPREPLY=()\n", f
    for (i = 1; i <= verb_count; i++)
        all_verbs = all_verbs " " verbs[i]
    if (verb_count)
        printf "    if [[ $COMP_CWORD = 1 ]]; then\n        mapfile -t COMPREPLY < <(compgen -W '%s --help --version' -- \"$word\")\n        return\n    fi\n",
            substr(all_verbs, 2)
    print "    case ${COMP_WORDS[1]} in"
    for (i = verb_count ? 1 : 0; i <= verb_count; i++) {
        printf "    %s)\n        case $last in\n", i ? verbs[i] : "*"
        cases(i ? verbs[i] : "")
        flags(i ? verbs[i] : "")
        print "        ;;"
    }
    printf "    esac\n}\ncomplete -F %s %s\n", f, program
}
