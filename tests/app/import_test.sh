#!/usr/bin/env bash
# Imported shaders and presets check, run on both backends with equal bits, and compute what NumPy says; wrong ones are refused with
# file and line, and nothing is written. TAP.
# shellcheck disable=SC2016 # GLSL in quotes; functions are called through check
. "$(dirname "$0")/../lib/tap.sh"
cp -r "$root/tests/app/import" "$work/in"
/usr/bin/python3 "$root/tests/app/import.py" table "$work/in" || exit 1
cd "$work" || exit 1

runs() { # file size frames option...
    local file=$1 size=$2 frames=$3
    shift 3
    "$diptych" compare --spec "$file" --size "$size" --frames "$frames" "$@"
}
holds() { # what spec size frames argument...; sets: in the array `sets`
    local what=$1 spec=$2 size=$3 frames=$4
    shift 4
    rm -rf dump
    "$diptych" render --spec "$spec" --size "$size" --frames "$frames" --backend vk --dump dump "${sets[@]}" &&
        /usr/bin/python3 "$root/tests/app/import.py" "$what" dump "$@"
}
refused() { # preset text
    local got
    ! "$diptych" import "in/$1" -o refused 2>err || return 1
    got=$(cat err)
    echo "$got"
    [[ $got == *"$2"* ]] && [ ! -e refused ]
}
sets=()

check "a compute shader becomes a spec" "$diptych" import in/sums.comp -o sums
check "the shader is as it was" cmp in/sums.comp sums/sums.comp
check "it runs at once" runs sums/sums.yaml 16x8 1
sets=(--set 'slope=[0.5, 2]' --set loose=0.25 --set step_size=5)
check "its uniforms, push constants and constants are the spec's" holds sums sums/sums.yaml 16x8 1
sets=()
check "SPIR-V of a pair, with a sampler of its own" bash -c '
    glslangValidator -V in/pair.vert -o v.spv && glslangValidator -V in/pair.frag -o f.spv'
check "becomes a spec" "$diptych" import v.spv f.spv -o pair --picture in/picture.png
sed -i 's/filter: linear/filter: nearest/' pair/v.yaml
check "the pair runs at once" runs pair/v.yaml 8x6 1
check "it draws the picture" holds pair pair/v.yaml 8x6 1
check "so does its GLSL alone" bash -c 'sed "s/texture2D/sampler2D/; /uniform sampler nearest/d; s/, sampler by//; s/sampler2D(of, by)/of/; s/, nearest//" \
    in/pair.frag >lone.frag && "$0" import lone.frag -o lone --picture in/picture.png && sed -i "s/filter: linear/filter: nearest/" lone/lone.yaml' "$diptych"
check "of a fragment shader without a vertex shader" holds pair lone/lone.yaml 8x6 1

check "a preset becomes a spec" "$diptych" import in/chain.slangp -o chain --picture in/picture.png
check "it agrees in three frames" runs chain/chain.yaml 16x6 3
check "scales, look-up, feedback, counter and mips are RetroArch's" holds chain chain/chain.yaml 16x6 2 1.0 2
sets=(--set gain=0.5)
check "no finding in its first frames, which have no history" "$diptych" compare --spec chain/chain.yaml --size 16x6 --frames 2 --sanitize=content
check "history in the third frame, and a live parameter" holds chain chain/chain.yaml 16x6 3 0.5 3
sets=()

check "HLSL with an entry point for each stage becomes a spec" "$diptych" import in/both.hlsl -o both
check "it runs at once" runs both/both.yaml 8x6 1
check "semantics, not their order, link its stages" "$diptych" compare --spec both/both.yaml --size 8x6 --sanitize
sed 's/+ 1/+ 9/' in/both.hlsl >both.hlsl
check "lines of HLSL" bash -c '"$0" import both.hlsl -o nine && ! "$0" compare --spec nine/both.yaml --size 8x6 --sanitize >told 2>&1 &&
    grep -q "both.hlsl:12:.*index 9 of an array of 4 elements" told' "$diptych"
check "HLSL of main() alone becomes a spec" "$diptych" import in/meant.hlsl -o meant
check "it computes what HLSL means" holds meant meant/meant.yaml 8x6 1
cat >parts.comp <<'END'
#version 450
#extension GL_EXT_nonuniform_qualifier : require
layout(local_size_x = 8) in;
layout(binding = 0) buffer Part { uint part[]; } parts[];
layout(binding = 1) buffer Sums { uint sums[]; };
void main() { sums[gl_LocalInvocationIndex] = parts[0].part[0] + parts[3].part[1]; }
END
check "buffers of an array without a length" bash -c '"$0" import parts.comp -o parts && grep "updates: .*parts_0, parts_3" parts/parts.yaml' "$diptych"
echo '#version 450
layout(points) in; layout(points, max_vertices = 1) out; void main() { EmitVertex(); }' >point.geom
check "a module of another stage" bash -c 'glslangValidator -V point.geom -o in/point.spv'
check "... is refused" refused point.spv "its entry point is of another stage than compute, vertex and fragment"
check "a module of two entry points" bash -c 'glslangValidator -V parts.comp -o one.spv && spirv-dis one.spv | sed "/OpEntryPoint/{p;s/\"main\"/\"other\"/}" | spirv-as --target-env spv1.0 - -o in/two.spv'
check "... is refused" refused two.spv "a module of one entry point is needed; this one has main, other"
check "doors that are held" /usr/bin/python3 "$root/tests/app/import_doors.py" "$diptych" "$build/diptych-gen" "$root/templates" "$work/doors"
check "a missing shader" refused missing.slangp "in/missing.slangp:2: shader0 = nowhere.slang: this shader cannot be used"
check "a scale of another kind" refused scale.slangp "in/scale.slangp:3: scale_type0 = golden: a scale is of source, viewport or absolute"
check "an unknown texture" refused unknown.slangp "the texture \`Elsewhere\` is neither a pass nor a picture of the preset"
check "an unknown format" refused format.slangp "in/format.slang:4: images do not have this format"
check "a vertex shader alone" refused pair.vert "give a compute shader, a fragment shader, or a vertex shader and a fragment shader"
check "GLSL with an error" bash -c 'echo "#version 450" >bad.comp; echo "void main() { x = 1; }" >>bad.comp; ! "$0" import bad.comp -o bad && [ ! -e bad ]' "$diptych"
finish
