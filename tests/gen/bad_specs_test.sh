#!/usr/bin/env bash
# Every wrong spec in tests/bad gets exactly the diagnostics beside it, exit status 1, and no output. Specs named warn_* are
# accepted with exactly their warnings. The patterns that editors use for compilers' output match every diagnostic. --check runs
# for every fourth wrong spec and for warn_*; its diagnostics are the same. TAP.
. "$(dirname "$0")/../lib/tap.sh"
gen=$build/diptych-gen
cd "$root/tests/bad" || exit 1

told_as_expected() { # name status option...
    local name=$1 want=$2 found
    shift 2
    "$gen" --templates ../../templates "$name.yaml" "$@" >/dev/null 2>"$work/found"
    found=$?
    echo "status $found, expected $want"
    diff -u "$name.expected" "$work/found" && [ "$found" = "$want" ]
}

nothing_written() {
    [ ! -e "$work/out" ] && [ ! -e "$work/out.dot" ] && [ ! -e "$work/out.d" ]
}

# The pattern of VS Code's problem matcher $gcc and of vim's %f:%l:%c: %t%*[a-z]: %m. Source lines and carets begin with a bar.
is_matched() { # file
    local line number=0
    while IFS= read -r line; do
        [[ $line =~ ^\ *[0-9]*\ \|\  ]] && continue
        [[ $line =~ ^(.*):([0-9]+):([0-9]+):\ +(warning|error|note):\ (.*)$ ]] || { echo "$1: $line" && return 1; }
        number=$((number + 1))
    done <"$1"
    [ "$number" -gt 0 ]
}

all_matched() {
    local file
    for file in *.expected; do
        is_matched "$file" || return
    done
}
check "editors find the place of each" all_matched

number=0
for spec in *.yaml; do
    name=${spec%.yaml}
    case $name in
    warn_*) check "$name is told as expected" told_as_expected "$name" 0 --check ;;
    *)
        check "$name is told as expected" told_as_expected "$name" 1 -o "$work/out" --graph "$work/out.dot" --depfile "$work/out.d"
        check "$name writes nothing" nothing_written
        [ $((number++ % 4)) != 0 ] || check "... and is told as much by --check" told_as_expected "$name" 1 --check
        ;;
    esac
done
finish
