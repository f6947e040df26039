#!/usr/bin/env bash
# Contracts from the spec to the verdict: what tests/specs/contracts.yaml says of each resource stands in the reflection
# (numbers, fractions and percentages; margins by resource and field). TAP.
. "$(dirname "$0")/tap.sh"
cd "$root" || exit 1
spec=tests/specs/contracts.yaml

check "a spec with every kind of contract is generated" "$build/diptych-gen" $spec -o "$work/contracts"

# shellcheck disable=SC2317 # called through check
reflects() { # resource contract
    tr -s ' \n' ' ' <"$work/contracts/contracts.c" | grep -oE "\.name = \"$1\",[^{]*\.contract = \{[^}]*\}" | tee "$work/found"
    grep -qF ".contract = {.kind = DT_CONTRACT_$2}" "$work/found"
}
while read -r resource contract; do
    check "the contract of $resource" reflects "$resource" "$contract"
done <<'END'
places ULP, .tolerance = 2
labels FLIPS, .tolerance = 1, .margin_resource = CONTRACTS_RESOURCE_MARGINS, .margin_field = 1
sides FLIPS, .tolerance = 2, .margin_resource = CONTRACTS_RESOURCE_SIDE_MARGINS, .margin_field = 0
sums REL, .tolerance = 0.01
margins ABS, .tolerance = 0.001
side_margins EXACT
picture IMAGE, .tolerance = 0.019607843137254902, .outliers = 0.001
levels FLIPS, .tolerance = 3, .margin_field = -1
stripes ULP, .tolerance = 2
END

check "both backends keep them" "$diptych" compare --spec $spec --scene scenes/cornell.yaml --size 17x9
finish
