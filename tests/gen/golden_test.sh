#!/usr/bin/env bash
# The generator's output. Header and graphs of tests/gen/golden/small.yaml equal the files of tests/gen/golden/small; UPDATE=1 rewrites
# these files. play_test compares every table of the C. The C compiles without a warning, the SPIR-V is valid, and the bytes depend on
# the spec alone. --set works for every type of parameter. TAP.
. "$(dirname "$0")/../lib/tap.sh"
gen=$build/diptych-gen
cd "$root" || exit 1
beside() { # description command...: no check of the generator's memory, so not for `ninja asan`
    [[ $build = */asan ]] || check "$@"
}

as_expected() { # file
    [ -z "${UPDATE:-}" ] || cp "$work/small/$1" "tests/gen/golden/small/$1"
    diff -u "tests/gen/golden/small/$1" "$work/small/$1"
}

compiles() { # folder [name]
    local file
    for file in "$work/$1/${2:-$1}"{,_gl_shaders,_vk_shaders}.c; do
        cc -std=c11 -Wall -Wextra -Werror -I. -Itemplates/c -Ibuild/glad/include \
            -fsyntax-only "$file" || return
    done
}

valid_spirv() { # name
    local file files count=0
    mapfile -t files < <(find "$work/$1" -name '*.spv')
    for file in "${files[@]}"; do
        case $file in
        */gl/*) spirv-val --target-env opengl4.5 "$file" ;;
        *) spirv-val --target-env vulkan1.3 "$file" ;;
        esac || { echo "$file" && return 1; }
        count=$((count + 1))
    done
    [ "$count" -gt 0 ]
}

# OpenGL's modules are made of Vulkan's, so glslang has not seen OpenGL's text. One process parses all: it starts in .08 s.
valid_text() { # name
    local files
    mapfile -t files < <(find "$work/$1/gl" -name '*.comp' -o -name '*.vert' -o -name '*.frag')
    [ ${#files[@]} -gt 0 ] && glslangValidator "${files[@]}"
}

names_nothing_of_here() { # name: the output contains no path, date or host name
    local word
    for word in "$root" "$work" "$(date +%Y-%m-%d)" "$(date '+%b %e %Y')"; do
        ! grep -rFa -- "$word" "$work/$1" || return
    done
    for word in "$HOSTNAME" "$(date +%Y)"; do
        ! grep -rFwI -- "$word" "$work/$1" || return
    done
}

spec_of() { # name
    local folder
    for folder in templates tests/gen/golden tests/specs; do
        [ ! -e "$folder/$1.yaml" ] || echo "$folder/$1.yaml"
    done
}

generate_elsewhere() ( # name
    spec=$(spec_of "$1")
    mkdir -p "$work/elsewhere" && cd "$work/elsewhere" || exit
    TZ=Asia/Tokyo HOME=/ LC_ALL=tr_TR.UTF-8 MALLOC_PERTURB_=171 "$gen" --templates "$root/templates" "$root/$spec" -o "./$1/"
)

for name in small kinds ssvp rsm; do
    check "$name is generated" "$gen" "$(spec_of $name)" -o "$work/$name"
    beside "$name is C11 without a warning" compiles $name
    if command -v spirv-val >/dev/null; then
        beside "$name has valid SPIR-V for both" valid_spirv $name
    else
        skip "$name has valid SPIR-V for both" "spirv-val is missing"
    fi
    beside "... and GLSL for OpenGL" valid_text $name
    beside "$name from elsewhere is generated" generate_elsewhere $name
    beside "... the same bytes" diff -r "$work/$name" "$work/elsewhere/$name"
    beside "$name names no path, host or date" names_nothing_of_here $name
done
check "small is generated for CPU drivers alone, and drawn" "$gen" tests/gen/golden/small.yaml --set target=software -o "$work/small" \
    --graph "$work/small/small.dot" --lifetimes "$work/small/small_lifetimes.dot"
for file in small.h small.dot small_lifetimes.dot; do
    check "$file is as expected" as_expected "$file"
done

check "a pipeline without live parameters is generated" "$gen" "$(spec_of lengths)" -o "$work/lengths"
beside "... and is C11 without a warning" compiles lengths

share_folder() { # name...: pipelines with passes of the same names
    local name
    for name in "$@"; do
        "$gen" "templates/$name.yaml" -o "$work/shared" || return
    done
    for name in "$@"; do
        ! diff -rq "$work/$name" "$work/shared" | grep -v "^Only in $work/shared" || return
    done
}
beside "two pipelines in one folder overwrite nothing of each other" share_folder ssvp rsm

words() { # folder backend: bytes of SPIR-V in generated C
    grep -o 'NULL, [0-9]*' "$work/$1/small_$2_shaders.c" | awk '{ sum += $2 } END { print sum }'
}
has_more() {
    grep -q '_glsl\[\]' "$work/more/small_gl_shaders.c" && ! grep -q _glsl "$work/small/small_gl_shaders.c" "$work/more/small_vk_shaders.c" &&
        [ "$(words more gl)" = "$(cat "$work"/more/gl/small.*.spv | wc -c)" ] && [ "$(words more gl)" -gt "$(words small gl)" ]
}
check "--names and --glsl are options" "$gen" tests/gen/golden/small.yaml -o "$work/more" --names --glsl --set target=software
check "... that add names and GLSL to generated C" has_more
beside "... which compiles" compiles more small

# `target: auto` has the shaders of `software`, and under gpu/ those of `gpu` that are others; one header for all.
is_both() { # name
    local file auto own=0
    for file in "$work/$1.gpu"/[gv]?/*.*; do
        auto=$work/$1.auto/${file#"$work/$1.gpu/"}
        cmp "$auto" "$work/$1.software/${file#"$work/$1.gpu/"}" || return
        case $file in *.spv) ;; *) continue ;; esac
        if [ -e "$(dirname "$auto")/gpu/$(basename "$file")" ]; then
            cmp "$file" "$(dirname "$auto")/gpu/$(basename "$file")" && ! cmp -s "$file" "$auto" || return
            own=$((own + 1))
        else
            cmp "$file" "$auto" || return
        fi
    done
    cmp "$work/$1.auto/$1.h" "$work/$1.gpu/$1.h" && cmp "$work/$1.auto/$1.h" "$work/$1.software/$1.h" && [ "$own" -gt 9 ]
}
for_target() { # name target
    "$gen" "templates/$1.yaml" -o "$work/$1.$2" --set "target=$2" >"$work/$1.$2.told"
}
for target in auto software gpu; do
    check "rsm for $target is generated" for_target rsm $target
    check "... and machine" for_target machine $target
done
check "rsm for both shares what is equal" is_both rsm
check "... and says what the others add" grep -q '; shaders for GPUs add 2[0-9][0-9] KB$' "$work/rsm.auto.told"
check "... its tables have both" grep -q '^    \.gpu = &panel_gpu,$' "$work/rsm.auto/rsm.c"
check "machine, which has no loops and no ranges, has nothing for GPUs alone" diff -r "$work/machine.auto" "$work/machine.gpu"
check "... and says nothing of them" diff "$work/machine.auto.told" "$work/machine.software.told"

# Every type as baked, live and uniform parameter: --set changes a constant in the GLSL, or a value in the C.
sets() { # type value baked live
    rm -rf "$work/set"
    "$gen" tests/specs/kinds.yaml -o "$work/set" --set "baked_$1=$2" --set "live_$1=$2" --set "uniform_$1=$2" || return
    grep -F "const $1 baked_$1 = $3;" "$work/set/vk/kinds.sum.comp" || return
    [ "$(grep -cF " .live_$1 = $4," "$work/set/kinds.c")" = 2 ] && grep -F " .uniform_$1 = $4," "$work/set/kinds.c"
}
# Shaders that read a number at run time do not contain it, not even as the length of a block.
same_shaders() { # folder pass...
    local api name
    for name in "${@:2}"; do
        for api in gl vk; do
            cmp "$work/ssvp/$api/ssvp.$name" "$1/$api/ssvp.$name" || return
        done
    done
}
check "ssvp with other numbers is generated" "$gen" templates/ssvp.yaml -o "$work/others" --set first_vpls=300 --set second_vpls=310 \
    --set clusters=9 --set second_clusters=5 --set map_size=200 --set rsm_size=300 --set kmeans_iterations=4
check "... k-means, views, maps and samples of them are the same shaders" same_shaders "$work/others" \
    first.kmeans.comp second.kmeans.comp first.place.comp second.place.comp sample_rsm.comp sample_maps.comp \
    first.map.place.comp second.map.place.comp first.pack.comp second.pack.comp first.map.vert first.map.frag first.measure.comp \
    rsm_triangles.frag rsm.comp
check_status 1 "... shading, whose loops are written out, is not" cmp "$work/ssvp/vk/ssvp.shade.comp" "$work/others/vk/ssvp.shade.comp"
check_status 1 "... nor is culling" cmp "$work/ssvp/vk/ssvp.first.map.test.comp" "$work/others/vk/ssvp.first.map.test.comp"

while read -r type value baked live; do
    check "--set of $type" sets "$type" "$value" "${baked//_/ }" "${live//_/ }"
done <<'END'
float 7.25            7.25                        7.25f
vec2  [7.25,8]        vec2(7.25,_8.0)             {7.25f,_8.0f}
vec3  [7.25,8,9]      vec3(7.25,_8.0,_9.0)        {7.25f,_8.0f,_9.0f}
vec4  [7.25,8,9,-1]   vec4(7.25,_8.0,_9.0,_-1.0)  {7.25f,_8.0f,_9.0f,_-1.0f}
int   -7              -7                          -7
ivec2 [-7,8]          ivec2(-7,_8)                {-7,_8}
ivec3 [-7,8,9]        ivec3(-7,_8,_9)             {-7,_8,_9}
ivec4 [-7,8,9,10]     ivec4(-7,_8,_9,_10)         {-7,_8,_9,_10}
uint  4000000000      4000000000u                 4000000000u
uvec2 [7,8]           uvec2(7u,_8u)               {7u,_8u}
uvec3 [7,8,9]         uvec3(7u,_8u,_9u)           {7u,_8u,_9u}
uvec4 [7,8,9,10]      uvec4(7u,_8u,_9u,_10u)      {7u,_8u,_9u,_10u}
bool  true            true                        1
END
for kind in baked live uniform; do
    for wrong in float=11 int=-11 "vec3=[1, 2]" bool=2; do
        check_status 1 "--set of ${kind}_$wrong is refused" \
            "$gen" --check tests/specs/kinds.yaml --set "${kind}_$wrong"
    done
done
check "a file that --set names lies beside the spec, also if --set names the pipeline" \
    "$gen" --check tests/specs/kinds.yaml --set pipeline=other --set passes.sum.shader=kinds_sum.glsl

# Question marks make no trigraphs.
keeps_question_marks() {
    mkdir -p "$work/marks"
    printf 'void main()\n{\n    grey_store(invocation().xy, vec4(level));\n}\n' >"$work/marks/marks.glsl"
    cat >"$work/marks/marks.yaml" <<'END'
pipeline: marks
params: {level: {value: 0.5, doc: "x???/ y??? z??!??"}}
images: {grey: {format: r32f, size: [8, 8]}}
passes:
  - {name: fill, dispatch: grey, writes: [grey], shader: marks.glsl}
END
    "$gen" "$work/marks/marks.yaml" -o "$work/marks/out" >/dev/null &&
        cc -std=c11 -Wall -Wextra -Wtrigraphs -Werror -I. -Itemplates/c -fsyntax-only "$work/marks/out/marks.c" &&
        cc -std=c11 -I. -Itemplates/c -E -P "$work/marks/out/marks.c" | grep -F 'x?' >"$work/marks/text" &&
        [ "$(grep -o '"x?[^"]*"' "$work/marks/text" | head -n 1 | sed 's/\\?/?/g')" = '"x???/ y??? z??!??"' ]
}
check "question marks make no trigraphs" keeps_question_marks
finish
