#!/usr/bin/env bash
# Every wrong spec in tests/bad gets exactly the diagnostics beside it, exit status 1, and no output; specs named warn_* are
# accepted with exactly their warnings. TAP.
set -u
root=$(cd "$(dirname "$0")/.." && pwd)
gen=$(realpath "${DIPTYCH_BUILD:-$root/build}")/diptych-gen
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$root/tests/bad" || exit 1

count=0
failed=0
report() { # good description
    count=$((count + 1))
    if [ "$1" = 1 ]; then
        echo "ok $count - $2"
    else
        echo "not ok $count - $2"
        failed=1
    fi
}

for spec in *.yaml; do
    name=${spec%.yaml}
    status=1
    [ "${name#warn_}" = "$name" ] || status=0
    "$gen" --check --templates ../../templates "$spec" >/dev/null 2>"$work/found"
    found=$?
    good=0
    if [ $found = $status ] && cmp -s "$name.expected" "$work/found"; then
        good=1
    else
        echo "# status $found, expected $status"
        diff -u "$name.expected" "$work/found" | sed 's/^/# /'
    fi
    report $good "$name is told as expected"
    [ $status = 1 ] || continue
    "$gen" --templates ../../templates "$spec" -o "$work/out" --graph "$work/out.dot" --depfile "$work/out.d" >/dev/null 2>&1
    found=$?
    good=0
    [ $found = 1 ] && [ ! -e "$work/out" ] && [ ! -e "$work/out.dot" ] && [ ! -e "$work/out.d" ] && good=1
    report $good "$name writes nothing"
done
echo "1..$count"
exit $failed
