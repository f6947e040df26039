#!/usr/bin/env bash
# Every wrong spec in tests/bad gets exactly the diagnostics beside it, exit status 1, and no output; specs named warn_* are
# accepted with exactly their warnings. TAP.
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
