#!/usr/bin/env bash
# Every wrong spec in tests/bad gets exactly the diagnostics beside it, exit status 1, and no output; specs named warn_* are
# accepted with exactly their warnings. What editors match in compilers' output matches every one of them. TAP.
. "$(dirname "$0")/tap.sh"
gen=$build/diptych-gen
cd "$root/tests/bad" || exit 1

# shellcheck disable=SC2317 # called through check
told_as_expected() { # name status
    local found
    "$gen" --check --templates ../../templates "$1.yaml" >/dev/null 2>"$work/found"
    found=$?
    echo "status $found, expected $2"
    diff -u "$1.expected" "$work/found" && [ "$found" = "$2" ]
}

# shellcheck disable=SC2317
writes_nothing() { # name
    "$gen" --templates ../../templates "$1.yaml" -o "$work/out" --graph "$work/out.dot" --depfile "$work/out.d"
    [ $? = 1 ] && [ ! -e "$work/out" ] && [ ! -e "$work/out.dot" ] && [ ! -e "$work/out.d" ]
}

# VS Code's problem matcher $gcc, and what vim makes of %f:%l:%c: %t%*[a-z]: %m. Lines of source and carets stand behind a bar.
# shellcheck disable=SC2317
is_matched() { # file
    local line number=0
    while IFS= read -r line; do
        [[ $line =~ ^\ *[0-9]*\ \|\  ]] && continue
        [[ $line =~ ^(.*):([0-9]+):([0-9]+):\ +(warning|error|note):\ (.*)$ ]] || { echo "$1: $line" && return 1; }
        number=$((number + 1))
    done <"$1"
    [ "$number" -gt 0 ]
}

# shellcheck disable=SC2317
all_matched() {
    local file
    for file in *.expected; do
        is_matched "$file" || return
    done
}
check "editors find the place of each" all_matched

for spec in *.yaml; do
    name=${spec%.yaml}
    case $name in
    warn_*) check "$name is told as expected" told_as_expected "$name" 0 ;;
    *)
        check "$name is told as expected" told_as_expected "$name" 1
        check "$name writes nothing" writes_nothing "$name"
        ;;
    esac
done
finish
