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

for fault in none cull offset uniform clock shader rows depth; do
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
check "... or the depth test" says 1 '^alone, .* first and second: .* outside the shader; what differs: depth test$' none.rdc depth.rdc

check "a matching is written" says 1 'flip in y' none.rdc rows.rdc --match match.json
sed -i '/"second": 2/,/rows/ s/"same"/"opposite"/' match.json
check "... and read as it was corrected" says 1 '^02_draw_96x96 .* opposite' none.rdc rows.rdc --match match.json
echo '{"passes": [{"first": 0, "second": 9, "rows": "same"}]}' >wrong.json
check "... but not with passes that are not there" says 2 'wrong.json: passes 0 and 9' none.rdc rows.rdc --match wrong.json
check "the draws of a pass are compared" says 1 '^first pass that differs: 00_draw_96x96' none.rdc cull.rdc --draws 00
check "... of one that is there" says 2 -- '--draws 17: no pass' none.rdc cull.rdc --draws 17
check "noise of runs is measured" says 1 'depth: breaks its contract in some runs' none.rdc,none.rdc none.rdc,offset.rdc --measure 2

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
    check "... and its passes match" says 01 '^0[01]_draw_160x96 .* opposite' qt_gl.rdc qt_vk.rdc
else
    skip "Qt Quick with both APIs" "qml-qt6, qml6-module-qtquick-window or qml6-module-qtqml-workerscript is not installed"
fi
finish
