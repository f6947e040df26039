#!/usr/bin/env bash
# The proof that a pipeline is exact, gen/spirv/prove.c. Every operation that the proof counts as exact is exact on each pair of
# drivers; tests/specs/proof.yaml has all these operations. --prove reports open operations at their places; prove_test.c tests
# them one by one.
. "$(dirname "$0")/../lib/tap.sh"
gen=$build/diptych-gen
spec=$root/tests/specs/proof.yaml

check "the proof finds nothing in tests/specs/proof.yaml" "$gen" "$spec" --prove
check "it compares equal" "$diptych" compare --spec "$spec" --size 32x16
check "... with GLSL text" "$diptych" compare --spec "$spec" --size 32x16 --glsl
. "$root/tests/lib/drivers.sh"
if [ ${#strangers[@]} -gt 0 ]; then
    check "... on ${strangers[*]}" "$diptych" compare --spec "$spec" --size 32x16 --set features=false --backend "vk@llvmpipe,${strangers[0]}"
else
    skip "... on another driver" "$no_strangers"
fi

lists_all() { # the shaders of the spec have every operation that the proof counts as exact
    local file
    "$gen" "$spec" -o "$work/out" >/dev/null || return
    for file in "$work"/out/*/*.spv; do
        spirv-dis "$file"
    done | grep -oE 'OpExtInst %[A-Za-z0-9_]+ %[a-z0-9_]+ [A-Za-z]+|BuiltIn [A-Za-z]+|Op[A-Z][A-Za-z0-9]+' |
        sed 's/.* //; s/^Op//; s/^ModfStruct$/Modf/' | sort -u >"$work/has"
    /usr/bin/python3 - "$root/gen/spirv/prove.c" >"$work/wants" <<'END' || return
import json, re, sys
text = open(sys.argv[1], encoding="utf-8").read()
with open("/usr/include/spirv/unified1/spirv.core.grammar.json", encoding="utf-8") as file:
    names = {item["opcode"]: item["opname"][2:] for item in json.load(file)["instructions"]}
codes = {name: code for code, name in names.items()}
families = text[text.index("bits and integers"):text.index("exact_operations[] =")]
wants = {names[code] for first, last in re.findall(r"{SpvOp(\w+), SpvOp(\w+)}", families)
         for code in range(codes[first], codes[last] + 1) if code in names}
for table in ("exact_operations", "exact_functions", "exact_inputs"):
    start = text.index(table + "[] =")
    wants |= set(re.findall(r"(?:SpvOp|GLSLstd450|SpvBuiltIn)(\w+)", text[start:text.index("};", start)]))
print(*sorted(wants - {"Line", "NoLine", "CopyLogical", "CopyObject", "CompositeInsert", "ModfStruct"}), sep="\n")
END
    [ "$(wc -l <"$work/wants")" -gt 90 ] && ! LC_ALL=C comm -23 <(LC_ALL=C sort "$work/wants") <(LC_ALL=C sort "$work/has") | grep .
}
if command -v spirv-dis >/dev/null; then
    check "it has everything that the proof counts as exact" lists_all
else
    skip "it has everything that the proof counts as exact" "spirv-dis is missing"
fi

told_as_expected() { # name status
    (cd "$root/tests/specs" && "$gen" --templates ../../templates "$1.yaml" --prove >/dev/null 2>"$work/found")
    [ $? = "$2" ] && diff -u "$root/tests/specs/$1.expected" "$work/found"
}
check "open operations are told at their places" told_as_expected proof_open 1
check "what the rasterizer decides in a draw of numbers is a warning" told_as_expected proof_edges 0
check "... but not of a pass whose resources have a tolerance" "$gen" "$root/tests/specs/proof_open.yaml" --prove --set 'contracts.default={ulp: 4}'
check "fixed functions of draws are told at their places" told_as_expected proof_fixed 1
sure() { # passes of proof_fixed.yaml in which the proof finds nothing leave on both drivers what they make of the same inputs
    "$diptych" compare --spec "$root/tests/specs/proof_fixed.yaml" --size 8x8 --backend "vk@llvmpipe,${strangers[0]}" >"$work/table"
    [ $? = 1 ] && [ "$(grep -c '^sure_' "$work/table")" = 10 ] && ! grep '^sure_' "$work/table" | grep -v ' none '
}
if [ ${#strangers[@]} -gt 0 ]; then
    check "... and where the proof finds none, another driver has the same" sure
else
    skip "... and where the proof finds none, another driver has the same" "$no_strangers"
fi
assumes() { # what the proof assumes is one line, the last
    "$gen" "$spec" --prove 2>&1 | tail -n 1 >"$work/last" && cat "$work/last" &&
        grep -q '^exact where .* no NaN, infinity or denormal number' "$work/last"
}
check "the proof says what it assumes" assumes
silent() { # for all pipelines that ship
    local spec
    for spec in "$root"/templates/*.yaml; do
        "$gen" "$spec" --prove --cache "$work/cache" >>"$work/forms" 2>>"$work/said" || return
    done
    cat "$work/said" && [ ! -s "$work/said" ]
}
check "every pipeline that ships is exact, without a word" silent
short() { # forms of all pipelines, each once
    sed -n 's/.*: remark: //p' "$work/forms" | grep -v ': library' | sort -u >"$work/short"
    [ "$(wc -l <"$work/short")" -gt 30 ] && "$build/tests/exact_arithmetic_test" "${SEED:-$RANDOM}" <"$work/short"
}
check "short forms have the bits of whole functions, over the ranges that are stated" short
same_forms() { # of the last pipeline, as lines and as JSON
    "$gen" "$spec" --prove --json "$work/proof.json" | sed -n 's/.*: remark: //p' >"$work/lines"
    /usr/bin/python3 -c 'import json, sys; print(*(form["message"] for form in json.load(sys.stdin)["forms"]), sep="\n")' <"$work/proof.json" | diff - "$work/lines"
}
check "... and are the same in JSON" same_forms
refuses_colour() { # of a scene draw
    ! "$gen" "$root/tests/specs/objects.yaml" --prove 2>"$work/found" && grep 'error: .position. is not exact: interpolation' "$work/found"
}
check "of a draw of colours interpolation is an error" refuses_colour
refuses_fast() {
    ! "$gen" "$spec" --prove --set exactness=fast 2>"$work/found" && grep 'error: .exactness: fast. leaves' "$work/found"
}
check "exactness: fast is told" refuses_fast
finish
