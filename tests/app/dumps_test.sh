#!/usr/bin/env bash
# `compare A B`: dumps of anybody's renderers. TAP.
. "$(dirname "$0")/../lib/tap.sh"
cd "$work" || exit 1
if ! /usr/bin/python3 -c 'import numpy' 2>"$work/output"; then
    skip "dumps of anybody" "needs python3-numpy"
    finish
fi

/usr/bin/python3 -B "$root/tests/app/dumps.py" "$work" || exit 1

# shellcheck disable=SC2317 # called through check
says() { # status, pattern, arguments...
    local want=$1 pattern=$2
    shift 2
    "$diptych" compare "$@" >"$work/said" 2>&1
    local got=$?
    cat "$work/said"
    [ "$got" = "$want" ] && grep -Eq -- "$pattern" "$work/said"
}

check "equal dumps agree" says 0 '^all 3 resources that both have agree$' plain plain
check "the first pass that differs is named" says 1 '^first pass that differs: light, resource radiance$' plain late
check "... with what makes both equal" says 1 '^why: radiance: equal after a flip in y' plain late
"$diptych" compare plain late --json json >/dev/null
check "... and in JSON" /usr/bin/python3 -c '
import json
j = json.load(open("json"))
r = j["results"][1]
assert j["exit_status"] == 1 and not j["agree"] and j["guilty"]["resource"] == "radiance", j
assert r["why"][0]["name"] == "flip_y" and r["why"][0]["after"] == 0 < r["why"][0]["before"], r'
check "resources without a partner are named" says 0 'bloom .* not in the second dump' more plain
check "... of the second as well" says 0 'bloom .* not in the first dump' plain more
check "formats are converted, and the note says so" says 0 'formats rgba32f and rgba8, compared as rgba8' wide narrow
check "row 0 at the top and at the bottom" says 0 'rows turned over' top bottom
check "fields are matched by name" says 0 'fields matched by name: 16 and 12 bytes' std140 packed
check "an integer in a buffer has no tolerance" says 1 'first pass that differs' integers other_integers
check "one ulp of a float is nothing" says 0 'agree' plain ulp
check "NaN in both is equal" says 0 '3 numbers are NaN or infinite in both' nan nan
check "NaN in one is not" says 1 'where nan2 is NaN|where second is NaN|NaN' nan nan2
check "a contract allows a difference" says 0 'within' plain ulp9 --contracts loose.yaml
check "... none is there by default" says 1 'first pass' plain ulp9
check "a wrong contract is told with its place" says 2 'wrong.yaml:2:.*did you mean' plain plain --contracts wrong.yaml
check "other sizes differ" says 1 '8x6x1 against 4x6x1 texels' size size2

check "noise has no reason" says 1 "^first pass" big other_big
check "... and none is given" sh -c "! grep ^why said"
check "half the size may be a mip" says 1 'one mip off, or half the resolution' size half

for bad in no_entries no_format no_file outside long fields version nothing link fortran short; do
    check "refused: $bad" says 2 "error: .*$bad" "$bad" plain
done
check "nothing in common" says 2 'nothing to compare' plain alone
check "one dump is too few" says 2 'two dumps' plain
check "options of a run are refused" says 2 'alone' plain plain --spec x.yaml

# What render --dump writes.
for backend in gl vk; do
    "$diptych" render --spec "$root/tests/specs/features.yaml" --scene "$root/scenes/cornell.yaml" --size 32x18 --backend $backend --dump $backend >"$work/output" 2>&1 ||
        cat "$work/output"
done
check "dumps of render agree" says 0 'agree$' gl vk

features=(--spec "$root/tests/specs/features.yaml" --scene "$root/scenes/cornell.yaml" --size 64x36)
check "backends are explained as well" says 1 '^why: blurred: differs where vk has one value' "${features[@]}" --fault vk:blur:missing
# shellcheck disable=SC2016
check "... but not a single number" sh -c '! grep "^why" "$1"' - <("$diptych" compare "${features[@]}" --fault vk:blur:bit 2>&1)

check "9 of 10 planted faults are named first" /usr/bin/python3 -B "$root/tests/app/why_faults.py" "$diptych" "$work/faults"
finish
