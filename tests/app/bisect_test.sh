#!/usr/bin/env bash
# compare --bisect writes the guilty pass to a folder; replay runs that pass alone: dispatches, draws, layers, mips and history.
# replay also works after the folder has moved, the project has changed and its cache is not writable. It refuses a damaged
# copy. TAP.
. "$(dirname "$0")/../lib/tap.sh"
specs=$root/tests/specs
scene=$root/scenes/cornell.yaml
cd "$work" || exit 1
cases=$work

# A copy of the project's bodies, library and tools, which the test changes later.
mkdir -p project/build/glad
cp "$build/diptych-gen" "$build/libdiptych_image.so" project/build/
cp "$planted" project/build/diptych
cp -r "$build/glad/include" project/build/glad/
cp -r "$root/templates" project/
ln -s "$root/app" "$root/runtime_gl" "$root/runtime_vk" "$root/scenes" project/
own=$work/project/build/diptych

# Faults in one backend, as a programmer makes them.
mkdir -p count scene remember slice halve
cp "$specs"/features* count/
cp "$specs"/features* scene/
cp "$specs"/features* remember/
cp "$specs"/features* slice/
cp "$specs"/mips* halve/
sed -i 's/histogram\[bin\].count = n;/histogram[bin].count = n;\n#ifdef VULKAN\n    histogram[bin].count += bin == 3 || bin == 5 ? 1u : 0u;\n#endif/' count/features_count.glsl
sed -i 's/    label = uvec4/#ifdef OPENGL\n    if (ivec2(gl_FragCoord.xy) == ivec2(8, 4)) color.r = 1.0 - color.r;\n#endif\n    label = uvec4/' scene/features_scene.glsl
sed -i 's/+ uint(i);/+ uint(i);\n#ifdef VULKAN\n    memory[i] += frame.index == 2u \&\& i == 1 ? 1u : 0u;\n#endif/' remember/features_remember.glsl
sed -i 's/    where = p;/    where = p;\n#ifdef VULKAN\n    where.z += gl_InstanceIndex == 2 ? 1.0 : 0.0;\n#endif/' slice/features_slice.glsl
sed -i 's/pyramid(p \* 2)/pyramid(p * 2)\n#ifdef VULKAN\n    + (p == ivec2(4, 6) ? vec4(0.5) : vec4(0.0))\n#endif\n    /' halve/mips_halve.glsl

bisected() { # pass resource region compare's options...
    local pass=$1 resource=$2 region=$3
    shift 3
    "$own" compare --scene "$scene" --size 17x9 "$@" --bisect "$cases/case.$pass" >table 2>log
    local status=$?
    cat table log
    [ "$status" = 1 ] && grep -qF "$resource: $region" table && grep -qF "$resource: $region" "case.$pass/README.txt" &&
        tail -n 1 table | grep -q "^guilty: pass $pass "
}
replayed() { # status text pass options...
    local status=$1 text=$2 pass=$3 got
    shift 3
    "$own" replay "$cases/case.$pass" "$@" >table 2>log
    got=$?
    cat table log
    [ "$got" = "$status" ] && tail -n 1 table | grep -qF -- "$text"
}

spec=features.yaml
check "a dispatch: elements of a buffer" bisected count histogram \
    "2 elements differ within [3..5]; smallest: [" --spec count/$spec
check "a draw: texels of an image" bisected scene color \
    "1 element differs within x 8, y 4; smallest: (8, 4)" --spec scene/$spec
check "history: the third frame" bisected remember memory \
    "1 element differs within [1]; smallest: [1]" --spec remember/$spec --frames 3
check "a mip" bisected halve "pyramid mip 1" \
    "1 element differs within x 4, y 6; smallest: (4, 6)" --spec halve/mips.yaml
check "a layer, with clip distances" bisected slice slices "4 elements differ within x 5, y 2..5, layer 2; smallest: (5, " --spec slice/$spec

cp -r "$specs"/parts* halve/
check "a pass of an included file" bisected three number "1 element differs within [0]" --spec halve/parts.yaml --fault vk:three:bit:4

check "a fault put in on purpose" bisected mark marks "1 element differs within [" --spec "$specs/$spec" --fault vk:mark:bit:4

# compare loads no text for OpenGL: it is made for the folder. A body that names an API, and one that does not.
as_generated() { # spec pass file...
    local spec=$1 pass=$2 file
    "$build/diptych-gen" "$spec" -o generated || return
    [ "$(cd "case.$pass/generated" && find . -type f | sort | paste -sd ' ')" = "${*:3}" ] || return
    for file in "${@:3}"; do
        cmp "case.$pass/generated/$file" "generated/${file%/*}/features.${file##*/}" || return
    done
}
check "the GLSL of a dispatch is in the folder, as diptych-gen writes it" as_generated "$specs/$spec" mark ./gl/mark.comp ./vk/mark.comp
check "... and that of a draw" as_generated slice/$spec slice ./gl/slice.{frag,vert} ./vk/slice.{frag,vert}

"$diptych" render --scene "$scene" --spec "$specs/mips.yaml" --size 17x9 --backend gl --dump dump >log 2>&1 || cat log
check "against a dump" bisected quarter "pyramid mip 2" \
    "1 element differs within x " --spec "$specs/mips.yaml" --against dump --backend vk --fault vk:quarter:texel

# From here replay must use the folders alone: they move, the sources change, the project's cache is not writable.
mkdir elsewhere
mv case.* elsewhere/ && cases=$work/elsewhere
for file in count/* scene/* remember/* slice/* halve/*.* halve/parts/* project/templates/*.yaml project/templates/*/*.glsl; do
    echo '#error changed since: { ]' >>"$file"
done
rm -rf project/build/cache && touch project/build/cache
export MESA_SHADER_CACHE_DIR=${MESA_SHADER_CACHE_DIR:-${XDG_CACHE_HOME:-$HOME/.cache}} XDG_CACHE_HOME=$work/cache
for pass in count scene remember slice halve; do # scene has its fault in OpenGL, the reference side
    check "$pass: gl leaves what was expected" replayed 0 "pass $pass on gl: as expected" $pass --backend gl
    check "$pass: vk does not, as before" replayed 1 "is not as expected, and all is bit for bit as vk had it" $pass --backend vk
done
check "quarter, held against a dump: gl leaves what was expected" replayed 0 "as expected, what " quarter --backend gl
check "a fault put in on purpose is not in the folder" replayed 0 "as expected" mark --backend vk
check "... nor one in a pass of an included file" replayed 0 "as expected" three --backend vk
check "a fault of another pass does not happen" replayed 0 "as expected" mark --backend vk --fault vk:count:texel
check "... since that does not run" bash -c '! grep "fault in pass" log'
check "... and may be put in again" replayed 1 "marks is not as expected, and all is bit for bit" mark --backend vk --fault vk:mark:bit:4
check "validation is silent, the other passes skipped" replayed 1 "is not as expected" halve --backend vk --debug
check "the table as JSON" replayed 1 "is not as expected" remember --backend vk --json "$work/replay.json"
check "... names pass, frame and element" /usr/bin/python3 -c '
import json, sys
replay = json.load(open(sys.argv[1]))
assert (replay["pass"], replay["frame"], replay["as_expected"]) == ("remember", 2, False), replay
result, = replay["results"]
assert result["resource"] == "memory" and result["differing"] == 1 and result["as_actual"], result
assert result["worst"]["element"] == 1, result' "$work/replay.json"

# replay runs the body in the folder: without the fault, Vulkan's result is as expected.
sed -i '/#ifdef VULKAN/,/#endif/d' "$cases/case.count/spec/features_count.glsl"
check "a body that was mended in the folder" replayed 0 "pass count on vk: as expected" count --backend vk

refuses() { # text command...
    local text=$1
    shift
    "$@" >table 2>log
    local status=$?
    cat table log
    [ "$status" = 2 ] && [ "$(grep -c 'error:' log)" = 1 ] && grep -qF -- "$text" log && [ ! -s table ]
}
damaged() { # text command...: the command damages a copy; replay refuses the copy with this text
    local text=$1
    shift
    rm -rf "$work/damaged" && cp -r "$cases/case.halve" "$work/damaged" && (cd "$work/damaged" && "$@") &&
        refuses "$text" "$own" replay "$work/damaged" --backend vk
}
check "a short file" damaged "inputs/pyramid.raw: has 100 bytes instead of 32768" truncate -s 100 inputs/pyramid.raw
check "a missing file" damaged "expected/pyramid.mip1.raw: cannot be read" rm expected/pyramid.mip1.raw
check "a missing key" damaged '"width" is missing or wrong' sed -i '/"width":\t17/d' manifest.json
check "a missing input" damaged 'names no file for pyramid mip 0 before pass halve' sed -i 's/"inputs"/"imputs"/' manifest.json
check "a foreign manifest" damaged "is no folder of compare --bisect" sed -i s/diptych_pass/other/ manifest.json
check "a later version" damaged "has version 2" sed -i 's/"diptych_pass":\t1/"diptych_pass":\t2/' manifest.json
check "a pass that is gone" damaged "has no pass half" sed -i 's/"pass":\t"halve"/"pass":\t"half"/' manifest.json
check "no folder" refuses "absent/manifest.json: cannot be read" "$own" replay absent --backend vk
check "no backend" refuses "--backend NAME is missing" "$own" replay "$cases/case.halve"

# --bisect writes a whole folder or none.
compare=("$planted" compare --scene "$scene" --spec "$specs/mips.yaml" --size 17x9)
mkdir foreign && touch foreign/mine
check "somebody's folder is refused" refuses "foreign: exists and was not written by an earlier --bisect" \
    "${compare[@]}" --fault vk:halve:bit --bisect foreign
check "... and left alone" test "$(ls -A foreign)" = mine
check_status 1 "an earlier one is replaced" "${compare[@]}" --fault vk:halve:bit --bisect "$cases/case.count"
check "... whole" test "$(sed -n 's/.*"pass":\t"\(.*\)",/\1/p' "$cases/case.count/manifest.json")" = halve
check "... with nothing of the former" test ! -e "$cases/case.count/spec/features_count.glsl"
check "two sides that agree" "${compare[@]}" --bisect none
check "... leave no folder" test ! -e none
check "nothing half-written is left" test -z "$(find "$work" -name '*.diptych-tmp-*')"
finish
