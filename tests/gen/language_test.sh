#!/usr/bin/env bash
# The language's table, its schema and its reference agree: shipped specs are valid by the schema, the reference has every key of
# the schema, and the schema accepts every example in the reference. Scenes, motions and outlines of reports and views are valid
# by their own schemas. Also tests the command line's errors and overrides, and that unchanged outputs are not rewritten.
# UPDATE=1 writes the schema that editors use. TAP.
. "$(dirname "$0")/../lib/tap.sh"
gen=$build/diptych-gen
cd "$root" || exit 1

says() { # text command...
    local text=$1
    shift
    "$@" 2>&1 | grep -qF -- "$text"
}

check "--schema prints" bash -c "'$gen' --schema >'$work/schema.json'"
[ -z "${UPDATE:-}" ] || cp "$work/schema.json" templates/diptych.schema.json
check "... what lies beside the specs" diff -u templates/diptych.schema.json "$work/schema.json"
check "--reference prints" bash -c "'$gen' --reference >'$work/LANGUAGE.md'"
python=/usr/bin/python3
if $python -c 'import jsonschema, yaml' 2>/dev/null; then
    check "every shipped YAML names a schema and is valid by it" $python tests/gen/language.py files \
        templates/*.yaml templates/*/report.yaml tests/specs/*.yaml tests/specs/grey/report.yaml scenes/*.yaml
    check "... and not with a misspelled key" $python tests/gen/language.py misspelled \
        templates/rsm.yaml templates/*/report.yaml tests/specs/features.yaml scenes/{cornell,atrium,cornell_walk}.yaml
    check "specs use every key of the language" $python tests/gen/language.py used "$work/schema.json" \
        templates/*.yaml templates/{shared,cull}/*.yaml tests/specs/*.yaml tests/specs/parts/*.yaml
    check "schemas of scenes and motions have the reader's keys" $python tests/gen/language.py keys \
        scenes/{scene,motion}.schema.json -- scenes/{scene,motion,camera_light}.c
    check "keys and examples of the reference fit the schema" \
        $python tests/gen/language.py reference "$work/schema.json" "$work/LANGUAGE.md"
    check "the reference lists the names that bodies have, and bodies use each" \
        $python tests/gen/language.py body "$work/LANGUAGE.md" tests/specs/body.yaml
    check "... which compiles for both backends" "$gen" tests/specs/body.yaml --check
else
    skip "the schema accepts the shipped specs" "python3-jsonschema or python3-yaml is missing"
fi

example_of_errors() (
    cp -r templates "$work/templates" && cd "$work" || return
    sed -i 's/{of: Vpl, count: first_vpls/{of: Vpl, count: first_vpl/; /name: sample_rsm/,/reads:/s/rsm_triangle/rsm_triangel/' templates/ssvp.yaml
    ! "$gen" templates/ssvp.yaml --check >/dev/null 2>errors || return
    sed -n '/^templates.ssvp.yaml:.*error/,/^```/p' "$root/README.md" | sed '/^```/d' | diff - errors
)
check "the README's example of errors" example_of_errors

check_status 2 "an unknown option" "$gen" --chek
check "... with a hint" says "did you mean \"--check\"?" "$gen" --chek
check_status 2 "no spec" "$gen"
check_status 2 "no -o" "$gen" templates/rsm.yaml
check_status 1 "a missing spec" "$gen" --check "$work/absent.yaml"
check "--help" says "usage: diptych-gen" "$gen" --help
check "--version" says "diptych-gen" "$gen" --version

spec=tests/bad/warn_unused.yaml
check "--set of a parameter" says "7 is not above" "$gen" --check $spec --set busy=7 --set 'asserts.0.that=busy > 9' \
    --set 'asserts.0.message="{busy} is not above 9"'
check "--set of one value twice: the last counts" says "9 is not above" "$gen" --check $spec --set busy=7 --set busy=9 \
    --set 'asserts.0.that=busy > 9' --set 'asserts.0.message="{busy} is not above 9"'
check "--set within a map that a later one replaces" "$gen" --check templates/rsm.yaml --set images.display.format=rgba16f \
    --set 'images.display={format: rgba8, size: frame}' --set images.display.format=rgba16f
check_status 1 "--set below an unknown name" "$gen" --check $spec --set bussy=7
check "... names the --set" says "\`--set bussy=7\`: no \`bussy\` in \`params\`; did you mean \`busy\`?" \
    "$gen" --check $spec --set bussy=7
check "--set of a wrong type points into the option" says "--set:1:6: error: \`busy\` has type int" \
    "$gen" --check $spec --set busy=1.5
check "--set adds a key" says "mip_filter" "$gen" --check $spec --set samplers.points.mip_filter=linear
is_silent() { # command...
    ! "$@" 2>&1 >/dev/null | grep .
}
check "--set in place of a name: that counts as used" is_silent "$gen" --check templates/ssvp.yaml --set metrics.vpl_distance.position=0.5
check "--set adds a contract, where there is none" "$gen" --check $spec --set 'contracts.other={rel: 1%}'
check "--set of a contract for nothing" says "no buffer or image \`bussy\`" \
    "$gen" --check $spec --set contracts.bussy=exact
check "--set without a value" says "expected PATH=VALUE" "$gen" --check $spec --set busy

check "generates" "$gen" $spec -o "$work/out" --depfile "$work/out/gen.d"
cp -r "$work/out" "$work/first"
touch "$work/stamp"
sleep 0.05
check "generates again" "$gen" $spec -o "$work/out" --depfile "$work/out/gen.d"
check "... the same bytes" diff -r "$work/out" "$work/first"
same_sanitized() {
    "$gen" templates/rsm.yaml --sanitize -o "$work/one" && "$gen" templates/rsm.yaml --sanitize -o "$work/two" && diff -r "$work/one" "$work/two"
}
check "... sanitized, too, whichever thread compiles first" same_sanitized
check "... and touches nothing" bash -c "[ -z \"\$(find '$work/out' -type f -newer '$work/stamp')\" ]"
check "no temporary file is left" bash -c "! find '$work/out' | grep -E '\.[A-Za-z0-9]{6}\$'"
check "the depfile names spec and shader" grep -q "tests/bad/fill.glsl" "$work/out/gen.d"
"$gen" tests/specs/parts.yaml -o "$work/parts" --depfile "$work/parts.d" >"$work/output" 2>&1
check "... and included specs" bash -c "grep -q tests/specs/parts/third.yaml '$work/parts.d' && grep -q templates/shared/space.glsl '$work/parts.d'"
check "--set of an unknown name suggests one of an included file" says "did you mean \`third\`?" \
    "$gen" --check tests/specs/parts.yaml --set thirt=4
check "... or its pass" says "did you mean \`three\`?" "$gen" --check tests/specs/parts.yaml --set passes.threee.local=4
check "--set of an include" says "includes cannot be set" "$gen" --check tests/specs/parts.yaml --set 'include=[a.yaml]'
touch "$work/file"
check_status 2 "a folder that cannot be made" "$gen" $spec -o "$work/file/out"
# A pass's macros are literals, so #if can use them; a parameter changes them.
defines() { # line...
    "$gen" tests/specs/features.yaml -o "$work/defines" --set bins=8 >&2 || return
    grep -B 1 -A 2 '^#define FACTOR 3$' "$work/defines/vk/features.mark.comp" | grep -qx '#define BIAS (-5)' &&
        ! grep -q FACTOR "$work/defines/vk/features.count.comp"
}
check "a pass's macros stand before its body" defines
check "--set of a macro" says 'BIAS' "$gen" --check tests/specs/features.yaml --set passes.mark.defines.BIAS=frame.width
# gpu_local is the workgroup in the plan for GPUs alone: 32 times the 8 words of a chunk.
workgroups() { # target width
    "$gen" tests/specs/cull.yaml --set "target=$1" -o "$work/cull.$1" && grep -q "(local_size_x = $2," "$work/cull.$1/vk/cull.slice.turn.comp"
}
check "a pass has another workgroup on GPUs" workgroups gpu 256
check "... and its own on CPU drivers" workgroups software 8
printf 'pipeline: row\nbuffers: {n: {of: uint, count: 300}}\npasses: [{name: run, dispatch: [300, 1], writes: [n], shader: row.glsl}]\n' >"$work/row.yaml"
echo 'void main() { if (invocation().x < 300) n[invocation().x] = 1u; }' >"$work/row.glsl"
one_row() {
    "$gen" "$work/row.yaml" -o "$work/row" && grep -q 'local_size_x = 64, local_size_y = 1,' "$work/row/vk/row.run.comp"
}
check "workgroups of a dispatch of one row have one row" one_row
# A pass samples one mip and updates another: texel reads are of the updated mip.
reads_updated() {
    "$gen" tests/specs/upsample.yaml -o "$work/upsample" || return
    local backend
    for backend in gl vk; do
        grep -A 2 '^vec4 pyramid(.*ivec2 p)$' "$work/upsample/$backend/upsample.up.comp" | grep -q imageLoad || return
    done
}
check "a texel of an image with a sampled and an updated mip is the updated one's" reads_updated
check "templates/README.md has what --needs prints of the shipped specs" \
    /usr/bin/python3 tests/gen/needs.py "$gen" templates/README.md templates/*.yaml
finish
