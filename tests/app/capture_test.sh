#!/usr/bin/env bash
# `diptych capture` and `compare A.rdc B.rdc`: programs that know nothing of diptych. Each fault that capture_scene.py plants is named.
# TAP.
. "$(dirname "$0")/../lib/tap.sh"
cd "$work" || exit 1
if ! /usr/bin/python3 -c 'import renderdoc' 2>"$work/output"; then
    skip "captures of any program" "needs renderdoc and python3-renderdoc"
    finish
fi
if [ -z "${DISPLAY:-}" ]; then
    skip "captures of any program" "needs a display, or xvfb"
    finish
fi
export LIBGL_ALWAYS_SOFTWARE=1 XDG_RUNTIME_DIR=$work QSG_RENDER_LOOP=basic
lavapipe=$(find /usr/share/vulkan/icd.d -name 'lvp_icd*.json' | head -n 1)
export VK_DRIVER_FILES=$lavapipe VK_ICD_FILENAMES=$lavapipe

captured() { # file frame command...
    local file=$1 frame=$2
    shift 2
    timeout 120 "$diptych" capture -o "$file" --frame "$frame" -- "$@" && [ -s "$file" ]
}
says() { # status, or statuses, pattern, arguments...
    local want=$1 pattern=$2
    shift 2
    timeout 300 "$diptych" compare "$@" >"$work/said" 2>&1
    local got=$?
    cat "$work/said"
    [[ $want == *$got* ]] && grep -Eq -- "$pattern" "$work/said"
}

# ---- Planted faults ---------------------------------------------------------------------------------------------------

for fault in none cull offset uniform clock shader rows; do
    captured $fault.rdc 3 /usr/bin/python3 -B "$root/tests/app/capture_scene.py" $fault >"$work/output" 2>&1
    tap_result $? "a program in OpenGL is captured: $fault"
done
pair() { # number from 0, condition in Python on p, its part of the JSON, and t, which state differs
    cat "$work/said"
    json_holds all.json "(lambda p: (lambda t: $2)(str(p['captures']['state'])))(d['pairs'][$1])"
}
says 1 . none.rdc none.rdc cull.rdc offset.rdc uniform.rdc clock.rdc shader.rdc rows.rdc --json all.json >"$work/output"
tap_result $? "seven captures are compared with the first"
check "a program agrees with itself" pair 0 'p["agree"] and t == "{}"'
check "culling is told as state" pair 1 '"cull: nocull against back" in t and p["guilty"]["pass"] == "00_draw_96x96"'
check "... a swapped polygon offset" pair 2 '"against factor 1, units 0.1: factor and units are swapped" in t'
check "... a uniform, by its name" pair 3 '"exposure: 1 against 1.25" in t and p["guilty"]["pass"] == "02_draw_96x96"'
check "another moment is told" pair 4 'p["captures"]["moments"]["01_draw_96x96"] == ["iTime: 0.22 against 0.49"]'
check "... before the passes" grep -Pzq 'not the same moment: iTime: 0.22 .*\n.*\npass ' "$work/said"
check "a shifted filter is told as a shift" pair 5 '"shift of " in str(p["results"][2]["why"])'
check "a target that is turned alone is a fault" pair 6 'p["guilty"]["pass"] == "01_draw_96x96" and "flip in y" in str(p["results"][2]["why"])'
check "state stands beside the first difference" says 1 '^beside it, in the state of 00_.*: cull: nocull against back$' \
    none.rdc cull.rdc --save saved --html page
check "... and on the page" grep -q 'cull: nocull against back' page/index.html
check "the shaders of the pass are saved" grep -q 'uniform mat4 place' saved/first/vertex.glsl
check "the pass alone shows that its shader is not the cause" grep -q '^alone, .* picture of first and second: .* outside the shader; what differs: cull$' said
check "... in a spec that runs" "$diptych" compare --spec saved/second/alone/alone.yaml
check "... or that its code is" says 1 '^alone, .* agree, .*: the cause is the code of the shader' none.rdc shader.rdc

check "a matching is written" says 1 'flip in y' none.rdc rows.rdc --match match.json
sed -i '/"second": 2/,/rows/ s/"same"/"opposite"/' match.json
check "... and read as it was corrected" says 1 '^02_draw_96x96 .* opposite' none.rdc rows.rdc --match match.json
echo '{"passes": [{"first": 0, "second": 9, "rows": "same"}]}' >wrong.json
check "... but not with passes that are not there" says 2 'wrong.json: passes 0 and 9' none.rdc rows.rdc --match wrong.json
check "the draws of a pass are compared" says 1 '^first pass that differs: 00_draw_96x96' none.rdc cull.rdc --draws 00
check "... of one that is there" says 2 -- '--draws 17: no pass' none.rdc cull.rdc --draws 17
check "noise of runs is measured" says 1 'depth: breaks its contract in some runs' none.rdc,none.rdc none.rdc,offset.rdc --measure 2

# ---- The same across APIs: Zink draws OpenGL with Vulkan --------------------------------------------------------------

cat >planted.yaml <<'END'
pipeline: planted
params: {moved: 0, turned: 0, twice: {value: 1, live: true}}
images:
  solid: {format: rgba8, size: [96, 96]}
  depth: {format: d32f, size: [96, 96]}
  soft:  {format: rgba8, size: [96, 96]}
  toned: {format: rgba8, size: [96, 96]}
samplers: {around: {kind: filter, filter: linear}}
passes:
  - {name: base, draw: {vertices: 6}, writes: [solid, depth], shader: base.glsl, blend: over, depth_bias: {slope: 0.5}}
  - {name: blur, draw: fullscreen, reads: [{name: solid, sampler: around}], writes: [soft], shader: blur.glsl}
  - {name: tone, draw: fullscreen, reads: [{name: soft, sampler: around}], writes: [toned], shader: tone.glsl, when: twice}
END
cat >base.glsl <<'END'
#ifdef VERTEX
layout(location = 0) out vec3 colour;
const vec2 at[6] = vec2[](vec2(-.8, -.7), vec2(.7, -.8), vec2(.1, .8), vec2(-.5, .6), vec2(.4, .5), vec2(.6, -.4));
void main() { colour = vec3(at[gl_VertexIndex] * .5 + .5, .3); gl_Position = vec4(at[gl_VertexIndex], .4 + .2 * colour.x, 1.0); }
#else
layout(location = 0) in vec3 colour;
void main() { solid = vec4(colour, 0.75); }
#endif
END
place='vec2(gl_FragCoord.x, turned == 1 ? 96.0 - gl_FragCoord.y : gl_FragCoord.y) / 96.0'
echo "void main() { soft = solid_sample($place + vec2(.3 + float(moved) * 2.0, 20.3) / 96.0); }" >blur.glsl
echo "void main() { toned = sqrt(soft_sample($place)); }" >tone.glsl
taken() { # backend file sets...
    ENABLE_VULKAN_RENDERDOC_CAPTURE=1 "$diptych" render --spec planted.yaml --backend "$1" --capture "$2.rdc" "${@:3}" >>"$work/output" 2>&1
}
faults=('p["agree"] and t == "{}"|moved=0' '"depth test: less against greater" in t|passes.base.depth=greater' '"blend: " in t|passes.base.blend=add'
    '"cull: nocull against back" in t|passes.base.cull=back' '"units 0 against factor 2.5, units 0" in t|passes.base.depth_bias.slope=2.5'
    '"scissor: whole against (0, 0, 50, 96)" in t|passes.base.scissor=[0,0,50,96]' '"viewport: (0, 0, 96, 96) against (8" in t|passes.base.viewport=[8,0,88,96]'
    '"linear, clampedge/clampedge against point/point" in t|samplers.around.filter=nearest' '"clampedge against linear/linear, wrap" in t|samplers.around.wrap=repeat'
    '"8 bits unorm against 16 bits float" in t|images.soft.format=rgba16f' '"shift of 2 texels" in str(p["results"][2]["why"])|moved=1'
    '"flip in y" in str(p["results"][2]["why"])|turned=1' 'len(p["captures"]["matched"]) == 2|twice=0')
seed=${SEED:-$RANDOM} most=${DIPTYCH_LONG:+99} # none and a depth test are always drawn, four others by the seed, all in long runs
mapfile -t drawn < <(RANDOM=$seed; for i in "${!faults[@]}"; do echo "$((i < 2 ? 0 : RANDOM)) $i"; done | sort -n | head -n "${most:-6}" | cut -d' ' -f2)
if taken gl across && taken zink 0; then
    echo "# SEED=$seed: faults ${drawn[*]}"
    for i in "${drawn[@]}"; do taken zink "$i" --set "${faults[i]#*|}"; done
    says 1 . across.rdc "${drawn[@]/%/.rdc}" --json all.json >"$work/output"
    for i in "${!drawn[@]}"; do check "OpenGL against Vulkan: ${faults[drawn[i]]#*|}" pair "$i" "${faults[drawn[i]]%|*}"; done
    check "... a depth test is no shader's fault" says 1 '^alone, .* gl and vk: .* outside the shader; what differs: depth test$' across.rdc 1.rdc
else
    skip "faults across APIs" "no Zink that RenderDoc captures"
fi

# ---- What is wrong ----------------------------------------------------------------------------------------------------

head -c 30000 none.rdc >cut.rdc
/usr/bin/python3 -c '
import random
data, pick = bytearray(open("none.rdc", "rb").read()), random.Random(1)
for _ in range(60):
    data[pick.randrange(3000, len(data))] ^= pick.randrange(1, 256)
open("damaged.rdc", "wb").write(data)'
check "a capture that is cut off ends with a message" says 2 'error: cut.rdc: ' none.rdc cut.rdc
check "... and a damaged one" says 2 'error: damaged.rdc: ' none.rdc damaged.rdc
check "... and a folder beside it" says 2 'captures are compared with captures' none.rdc .
check_status 1 "a program that ends is told" "$diptych" capture -o x.rdc --frame 3 -- /bin/true
check_status 1 "... and one that is not there" "$diptych" capture -o x.rdc -- no-such-program
check_status 2 "... and none" "$diptych" capture -o x.rdc
check "nothing is left of them" test ! -e x.rdc
check "a replay that was taken over names its own files alone" env PYTHONPATH="$root/app/python" /usr/bin/python3 -c '
import json, os
from diptych.console import Console, Failure
from diptych.rdc.compare import Replays
os.makedirs("left/below"), os.symlink("/etc/passwd", "left/link"), open("left/own", "w").close(), open("left/small.npz", "w").close()
def frame(name):
    with open("left/frame.json", "w") as file:
        json.dump({"passes": [{"entries": [{"file": name}], "inputs": [], "shaders": []}]}, file)
    return Replays(Console("compare", []), True).frame("x.rdc", "left")
frame("own")
for name in ("/etc/passwd", "../none.rdc", "below", "below/../own", "./own", "link", "absent", ""):
    try:
        frame(name)
    except Failure:
        continue
    raise SystemExit(f"{name} was taken")'

check "a replay that shows another picture proves nothing; one backend alone is blamed" env PYTHONPATH="$root/app/python" /usr/bin/python3 -c '
import numpy as np
from types import SimpleNamespace
from diptych.rdc.guilty import verdict
ramp = np.linspace(0, 1, 256, dtype="f4").reshape(8, 8, 4)
def told(gl, vk):  # what both backends leave, of sides that are .2 apart
    sides = [SimpleNamespace(label=label, why="", own=[ramp + own], ours={"gl": [ramp + own + gl], "vk": [ramp + own + vk]},
                             made={"left": [], "textures": [], "shader": label}, source="") for label, own in (("a", 0), ("b", 0.2))]
    return verdict(sides, True, False, ["cull: none against back"])
for words, gl, vk in (("outside the shader; what differs: cull", 0, 0.001), ("does not show the picture of a: 64 of 64 texels", 0.1, 0.1),
                      ("differ, too: 64 of 64 texels", 0.0, 0.1), ("differ, too: 64 of 64 texels", 0.1, 0.0)):
    if words not in told(gl, vk):
        raise SystemExit(told(gl, vk))'

# ---- Programs of packages ---------------------------------------------------------------------------------------------

/usr/bin/python3 -c '
import struct, zlib
def chunk(kind, data): return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
rows = b"".join(b"\0" + bytes(v for x in range(160) for v in (x, 2 * y, x ^ y)) for y in range(96))
open("ramp.png", "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 160, 96, 8, 2, 0, 0, 0)) +
                             chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))'
film() { # api more...
    local api=$1
    shift
    captured "mpv_$api.rdc" 4 mpv --no-config --vo=gpu-next --gpu-sw --gpu-api="$api" "$@" --image-display-duration=0.2 --no-audio --osc=no \
        --osd-level=0 --loop=inf --really-quiet --geometry=160x96 ramp.png
}
device=$(mpv --vulkan-device=help 2>/dev/null | sed -n "s/^ *'\(llvmpipe[^']*\)'.*/\1/p" | head -n 1)
if [ -n "$device" ]; then
    check "mpv is captured with OpenGL" film opengl
    check "... and with Vulkan" film vulkan "--vulkan-device=$device"
    check "... and its passes match" says 01 '^00_draw_160x96 +00 draw 160x96 +0. draw 160x96.* opposite' mpv_opengl.rdc mpv_vulkan.rdc
else
    skip "mpv with both APIs" "mpv is not installed, or finds no lavapipe"
fi
qml=$(command -v qml6 || find /usr/lib/qt6/bin -name qml 2>/dev/null | head -n 1)
cat >scene.qml <<'END'
import QtQuick
Window { visible: true; width: 160; height: 96; color: "#203040"
    Rectangle { x: 20; y: 20; width: 60; height: 40; radius: 12; color: "#e06040"; rotation: 10 }
    Item { x: 90; y: 20; width: 50; height: 50; layer.enabled: true
        Rectangle { anchors.fill: parent; gradient: Gradient { GradientStop { position: 0; color: "yellow" } GradientStop { position: 1; color: "blue" } } } }
    Rectangle { width: 2; height: 2; NumberAnimation on x { from: 0; to: 1; loops: Animation.Infinite; duration: 100000 } } }
END
if [ -n "$qml" ] && QT_QPA_PLATFORM=offscreen timeout 3 "$qml" scene.qml >"$work/output" 2>&1; [ $? = 124 ]; then
    check "Qt Quick is captured with OpenGL" captured qt_gl.rdc 10 "$qml" scene.qml
    export QSG_RHI_BACKEND=vulkan
    check "... and with Vulkan" captured qt_vk.rdc 10 "$qml" scene.qml
    check "... and its passes match, and agree" says 0 '^0[01]_draw_160x96 .* opposite' qt_gl.rdc qt_vk.rdc
    sed -i 's/rotation: 10/& ; opacity: 0.5/' scene.qml
    check "... and once more" captured qt_other.rdc 10 "$qml" scene.qml
    check "... which tells a uniform of another value" says 1 'opacity: 1 against 0.5' qt_gl.rdc qt_other.rdc
else
    skip "Qt Quick with both APIs" "qml-qt6, qml6-module-qtquick-window or qml6-module-qtqml-workerscript is not installed"
fi
finish
