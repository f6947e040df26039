#!/usr/bin/env bash
# Contracts from the spec to the verdict. The reflection has each contract of tests/specs/contracts.yaml: numbers, fractions and
# percentages, margins by resource and field. compare judges a fault by the contract; --pictures shows the differences.
# TAP.
. "$(dirname "$0")/../lib/tap.sh"
cd "$root" || exit 1
spec=tests/specs/contracts.yaml

check "a spec with every kind of contract is generated" "$build/diptych-gen" $spec -o "$work/contracts"

reflects() { # resource contract
    tr -s ' \n' ' ' <"$work/contracts/contracts.c" | grep -oE "\.name = \"$1\",[^{]*\.contract = \{[^}]*\}" | tee "$work/found"
    grep -qF ".contract = {.kind = DT_CONTRACT_$2}" "$work/found"
}
while read -r resource contract; do
    check "the contract of $resource" reflects "$resource" "$contract"
done <<'END'
places ULP, .tolerance = 2
labels FLIPS, .tolerance = 1, .margin_resource = CONTRACTS_RESOURCE_MARGINS, .margin_field = 1
sides FLIPS, .tolerance = 2, .margin_resource = CONTRACTS_RESOURCE_SIDE_MARGINS
sums REL, .tolerance = 0.01
margins ABS, .tolerance = 0.001
side_margins EXACT
picture IMAGE, .tolerance = 0.0196078431372549, .outliers = 0.001
levels FLIPS, .tolerance = 3, .margin_field = -1
stripes ULP, .tolerance = 2
END

compare=("$diptych" compare --spec "$spec" --scene scenes/cornell.yaml --size 17x9)
check "both backends keep them" "${compare[@]}"

# One point at x = 1/2, exactly on the edge between the sides, so the last bit of x decides. Seed 2 makes the fault choose x.
flip=("$planted" "${compare[@]:1}" --set points=1 --fault vk:place:bit:2)
loose=(--set 'contracts.side_margins={abs: 1/1000}')
finds() { # status text command...
    local status=$1 text=$2
    shift 2
    "$@" | tee "$work/found"
    [ "${PIPESTATUS[0]}" = "$status" ] && grep -qF -- "$text" "$work/found"
}
told="  flip at [0], frame 0: gl 0 (0x00000000), vk 1 (0x00000001); margin gl 0 (0x00000000), vk 5.9604645e-08 (0x33800000)"
check "a flip within the contract is told with its margins" finds 0 "$told" "${flip[@]}" "${loose[@]}"
check "... and nothing breaks" grep -qF "all 9 resources of 3 passes agree" "$work/found"
check "one flip too many is a difference" finds 1 "pass decide is the first to break: sides" \
    "${flip[@]}" "${loose[@]}" --set contracts.sides.flips=0
check "an exact resource beside it is held to the bit" finds 1 "pass decide is the first to break: side_margins" "${flip[@]}"

told="24 numbers are NaN or Inf in both, the first at [0], frame 0: gl Inf (0x7f800000), vk Inf (0x7f800000)"
check "infinity in both is not finite, under any tolerance" finds 1 "$told" "${compare[@]}" --set parts=0 --html "$work/page" \
    --json "$work/found.json" --junit "$work/found.xml"
check "... the last line says so, and blames no pass" [ "$(tail -n 1 "$work/found")" = "both agree; pass decide leaves infinity" ]
check "... JSON" json_holds "$work/found.json" 'not d["agree"] and d["not_finite"]["pass"] == "decide" and d["not_finite"]["what"] == "infinity" and \
    d["first_break"] is d["guilty"] is None and "not finite" in [r["verdict"] for r in d["results"]]'
check "... the page" grep -q "agree; pass decide leaves infinity" "$work/page/index.html"
check "... JUnit" grep -q 'failure message="both agree; 24 numbers' "$work/found.xml"
check "a difference beside it is told before" finds 1 "pass decide is the first to break" \
    "${flip[@]}" --set parts=0

pictures() { # expected number of strips; options...
    local expected=$1 found file
    shift
    rm -rf "$work/pictures"
    "$planted" "${compare[@]:1}" --pictures "$work/pictures" --json "$work/found.json" "$@" >"$work/found"
    found=$(find "$work/pictures" -name '*.png' | wc -l)
    echo "$found strips"
    cat "$work/found"
    [ "$found" = "$expected" ] && [ "$(grep -c '^  picture ' "$work/found")" = "$expected" ] &&
        [ "$(grep -c '"picture":' "$work/found.json")" = "$expected" ] || return
    find "$work/pictures" -name '*.png' | while read -r file; do
        grep -qF "  picture $file: difference" "$work/found" && grep -qF "\"$file\"" "$work/found.json" || return
        [ "$(head -c 8 "$file" | od -An -tx1 | tr -d ' ')" = 89504e470d0a1a0a ] || return
    done
}
check "equal images have no picture" pictures 0
check "an image that differs has one" pictures 1 --fault vk:paint:texel:9
check "... of both sides: 1.25 against 0" grep -qF "02.paint.stripes.png: difference x 0.5" "$work/found"
check "a missing pass has one of each" pictures 3 --fault vk:paint:missing
check_status 2 "a folder that cannot be made" "${compare[@]}" --pictures "$0/folder"

# The table's share of the bound, contracts of a file in place of the spec's, and measured ones.
printf 'stripes: {abs: 5}\nsides: {flips: 4, margin: side_margins}\nside_margins: {abs: 0.001}\n' >"$work/wide.yaml"
check "a file's contracts replace the spec's" finds 0 "all 9 resources of 3 passes agree" "$planted" "${compare[@]:1}" --contracts "$work/wide.yaml" --fault vk:paint:texel:9
check "... and the share of the bound stands in the table" grep -Eq '^paint +stripes .* within +25 %  1.25 at' "$work/found"
check "... with margins that they name" finds 0 "; margin gl 0 (0x00000000), vk 5.9604645e-08 (0x33800000)" "${flip[@]}" --contracts "$work/wide.yaml"
printf 'sums: {image: {max: 1}}\n' >"$work/wrong.yaml"
check_status 2 "outliers of a buffer are refused" "${compare[@]}" --contracts "$work/wrong.yaml"
check "runs are measured, side by side" finds 0 "equal in all runs" "${compare[@]}" --measure 2 --write-contracts "$work/measured.yaml"
check "... and the contracts are read again" finds 1 "grown: stripes, difference of backends: none when it was measured, is 1.25" \
    "$planted" "${compare[@]:1}" --measure 2 --contracts "$work/measured.yaml" --fault vk:paint:texel:9
check "memory that no pass has written is noise" finds 1 "grown: stripes, noise of vk: none when it was measured" \
    "$planted" "${compare[@]:1}" --measure 2 --contracts "$work/measured.yaml" --fault vk:paint:missing
check_status 2 "too many processes" "${compare[@]}" --measure 33
check_status 2 "a dump is one run" "${compare[@]}" --measure 2 --against "$work"
finish
