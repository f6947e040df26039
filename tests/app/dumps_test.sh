#!/usr/bin/env bash
# `compare A B`: dumps of anybody's renderers. TAP.
. "$(dirname "$0")/../lib/tap.sh"
cd "$work" || exit 1
if ! /usr/bin/python3 -c 'import numpy' 2>"$work/output"; then
    skip "dumps of anybody" "needs python3-numpy"
    finish
fi

/usr/bin/python3 -B "$root/tests/app/dumps.py" "$work" || exit 1

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
check "packed formats, depth in its own codes, samples" says 0 'formats d24 and d32f, compared as d24' dense dense2
check "... all nine of seven entries" grep -qx 'all 9 resources that both have agree' said
check "... depth in its own codes" says 1 'DIFFERS +200 %  2 ulp at .*\.d.*: dense' dense dense_depth
check "... stencil apart" says 1 'first pass that differs: light, resource zs.stencil' dense dense_stencil
check "row 0 at the top and at the bottom" says 0 'rows turned over' top bottom
check "fields are matched by name" says 0 'fields matched by name: 16 and 12 bytes' std140 packed
check "an integer in a buffer has no tolerance" says 1 'first pass that differs' integers other_integers
check "one ulp of a float is nothing" says 0 'agree' plain ulp
check "NaN in both is not finite" says 1 '^both agree; pass gbuffer leaves NaN$' nan nan --json json
check "... in JSON as two backends have it" /usr/bin/python3 -c '
import json
j = json.load(open("json"))
assert j["not_finite"]["what"] == "NaN" and j["guilty"] is None and not j["agree"] and j["results"][0]["verdict"] == "not finite", j'
check "zeros of two signs are equal" says 0 '^a +b +48 +0 +equal' zeros minus
check "NaN in one is not" says 1 'where nan2 is NaN|where second is NaN|NaN' nan nan2
check "a contract allows a difference" says 0 'within' plain ulp9 --contracts loose.yaml
check "... none is there by default" says 1 'first pass' plain ulp9
check "a wrong contract is told with its place" says 2 'wrong.yaml:2:.*did you mean' plain plain --contracts wrong.yaml
check "other sizes differ" says 1 '8x6x1 against 4x6x1 texels' size size2

check "... by an exact name of what is missing" says 2 'margin: the first dump has no buffer of floats' flags flipped --contracts no_margin.yaml
check "two bounds are refused" says 2 'exactly one of' plain plain --contracts two.yaml
check "a share is at most 1" says 2 'share.yaml:1:.*raster. is a number from 0 to 1' plain plain --contracts share.yaml
check "differences at edges may be allowed" says 0 'within +7[0-9] %' drawn at_edge --contracts raster.yaml
check "... and no others" says 1 'first pass that differs: draw, resource picture' drawn elsewhere --contracts raster.yaml
check "... as a reason counts" says 1 'picture: equal after a flip in y.*.36 differ before, 0 after' drawn turned --contracts raster.yaml
check "a frame late without numbers" says 1 'radiance: equal one frame late: late_by_one has the frame before' on_time late_by_one
check "flips are listed with their margins" says 0 'flip at \[1\].*margin flags 0.125 ' flags flipped --contracts flips.yaml
check "... and use half of the bound" grep -Eq '^cull +visible .* within +50 %' said
check "outliers are a share" says 0 'within +100 %' plain speck --contracts image.yaml

mkdir kept
fails() { # folder for the page
    ! "$diptych" compare plain absent --html "$1"
}
check "a comparison that fails keeps the folder that was there" fails kept
check "... which is there" [ -d kept ]
check "and removes one that it made" fails made
check "... which is gone" [ ! -e made ]
check "three dumps: the first against each" says 1 '^late against plain$' plain ulp late --html page --pictures strips --junit xml --json json
check "... names both pairs in JSON" /usr/bin/python3 -c '
import json
j = json.load(open("json"))
assert not j["agree"] and [p["agree"] for p in j["pairs"]] == [True, False], j
assert j["pairs"][0]["results"][0]["of_bound"] == 1, j'
check "... and in a page, strips and XML" /usr/bin/python3 -B "$root/tests/app/dumps_pages.py"

check "runs are measured" says 1 'gbuffer +depth +equal in all runs' runs/gl runs/vk --measure 3 --write-contracts measured.yaml --json json
check "... noise of a side apart from the difference" /usr/bin/python3 -c '
import json
m = json.load(open("json"))["measured"][1]
gl, vk, between = m["noise"]["gl"], m["noise"]["vk"], m["backends"]
assert gl["differing"] == 0 and gl["pairs"] == vk["pairs"] == 3 and between["pairs"] == 9, m
assert 1 <= vk["ulp"] <= 4 and 0.0009 < between["median"] < between["largest"] * 1.01 < 0.0011, m'
check "... with contracts that pass" says 0 'light +radiance .* within ' runs/gl runs/vk --measure 3 --contracts measured.yaml
check "... as tight as the largest error" grep -Eq '^light.radiance: \{rel: 0.00[01][0-9]+, noise: [0-9.e-]+, backends: 0.00[01][0-9]+\} +# noise of a side: .* largest' measured.yaml
check "... and exact where all is equal" grep -q '^gbuffer.depth: exact  # equal in all runs$' measured.yaml
check "noise that has grown is told" says 1 '^grown: light.radiance, noise of noisy: ' runs/gl runs/noisy --measure 3 --contracts measured.yaml
check "... and a difference, also of one run" says 1 '^grown: light.radiance, difference of backends: 0.00.* when it was measured, is 0.0' runs/gl/0 runs/far/0 --contracts measured.yaml
check "... and nothing else" [ "$(grep -c ^grown said)" = 1 ]
check "a contract that only some runs break" says 1 '^light, radiance: breaks its contract in some runs$' runs/gl runs/noisy --measure 3 --contracts measured.yaml
check "... is no agreement" grep -qx 'the first runs agree, but not all do' said

check "two versions of one backend drift" says 1 'drift ' versions/0 versions/1 --measure 2 --write-contracts drift.yaml
keeps() { # each run of one version against each of the other
    local a b
    for a in 0 1; do
        for b in 0 1; do
            says 0 'all 4 resources' "versions/0/$a" "versions/1/$b" --contracts drift.yaml || return
        done
    done
}
check "... and all runs keep what is written" keeps
check "... in the measure that is tightest" /usr/bin/python3 -c '
import re
text = open("drift.yaml").read()
found = dict(re.findall(r"^p\.(\w+): \{(\w+)", text, re.M))
assert found == {"codes": "ulp", "far": "image", "near": "ulp", "counts": "flips"}, text
assert "p.codes: {ulp: 5, noise: 5, drift: 5}" in text and "p.counts: {flips: 3, noise: 0, drift: 3}" in text and "p.near: {ulp: 5, noise: 0, drift: 5}" in text, text'
sed -i 's/flips: 3/flips: 2/' drift.yaml
check "... no tighter one" says 1 'first pass that differs: p, resource counts' versions/0/0 versions/1/0 --contracts drift.yaml
check "a run too few" says 2 'runs/gl: --measure 4 needs 4 dumps' runs/gl runs/vk --measure 4
check "contracts need runs" says 2 'needs --measure' plain plain --write-contracts x.yaml

check "noise has no reason" says 1 "^first pass" big other_big
check "... and none is given" sh -c "! grep ^why said"
check "half the size may be a mip" says 1 'one mip off, or half the resolution' size half

for bad in no_entries no_format no_file outside long fields version nothing link fortran short bool16; do
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
diptych=$planted check "backends are explained as well" says 1 '^why: blurred: differs where vk has the pattern of memory that nothing has written' "${features[@]}" --fault vk:blur:missing --html own
check "... on their page as well" grep -q 'Why: differs where vk has the pattern of memory' own/index.html
# shellcheck disable=SC2016
check "... but not a single number" sh -c '! grep "^why" "$1"' - <("$planted" compare "${features[@]}" --fault vk:blur:bit 2>&1)

check "planted faults are named first, decoys get no reason" /usr/bin/python3 -B "$root/tests/app/why.py"
finish
