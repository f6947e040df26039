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
# Replays are --trusted and share what Mesa has compiled, which takes a third of the time, but where `confined` is set: in a sandbox,
# each compiles all anew.
says() { # status, or statuses, pattern, arguments...
    local want=$1 pattern=$2 trust=(--trust)
    shift 2
    [ -z "${confined:-}" ] || trust=()
    timeout 900 "$diptych" compare "$@" "${trust[@]}" >"$work/said" 2>&1
    local got=$?
    cat "$work/said"
    [[ $want == *$got* ]] && grep -Eq -- "$pattern" "$work/said"
}

# ---- Planted faults ---------------------------------------------------------------------------------------------------

scene=$root/tests/app/capture_scene.py
frames() { # folder variable of the driver... -- names of frames
    mkdir -p "$1" && cd "$1" && env "${@:2}" >"$work/output" 2>&1 && cd ..
}
pair() { # number from 0, condition in Python on p, its part of the JSON, t, which state differs, b, what differs, and w, the reasons for 01.color0
    cat "$work/said"
    json_holds all.json "(lambda p: (lambda t, b, w: ${2%|*})(str(p['captures']['state']), {r['pass'].split('_', 1)[0] + '.' + r['resource']
        for r in p['results'] if r['verdict'] == 'DIFFERS'}, str([r.get('why') for r in p['results']
        if r['pass'] + r['resource'] == '01_draw_96x96color0'])))(d.get('pairs', [d])[$1])"
}
judged() { # folder of captures, both APIs, "condition|name of the fault"...
    local i files=("${@:3}")
    files=("${files[@]/#*|/$1/}")
    says 1 . none.rdc "${files[@]/%/.rdc}" --json all.json >"$work/output"
    for i in "${!files[@]}"; do check "$2: ${files[i]##*/}" pair "$i" "${@:i+3:1}"; done
}
seed=${SEED:-$RANDOM}
drawn() ( # number fault...: the first two, and others by the seed; all in long runs
    RANDOM=$seed
    for ((i = 2; i <= $#; i++)); do echo "$((i < 4 ? 0 : RANDOM)) ${!i}"; done | sort -n | head -n $((${DIPTYCH_LONG:-0} ? 99 : $1)) | cut -d' ' -f2-
)
printf "#!/bin/sh\nexec /usr/bin/python3 -B \"\$@\"\n" >wrapper && chmod +x wrapper
check "a program in OpenGL, which a script starts, is captured" captured once.rdc 3 ./wrapper "$scene"
check "... and faults in it, by itself" frames gl LD_PRELOAD=librenderdoc.so /usr/bin/python3 -B "$scene" \
    none cull offset uniform clock shader rows vertices channels clear before parts alpha read levels block discard cover covered
mv gl/*.rdc .
faults=('p["agree"] and t == "{}"|once' 'p["captures"]["moments"]["01_draw_96x96"] == ["iTime: 0.22 against 0.49"]|clock'
    '"cull: nocull against back" in t and p["guilty"]["pass"] == "00_draw_96x96"|cull'
    '"against factor 0, units 0.5: factor and units are swapped" in t|offset'
    '"exposure: 1 against 1.25" in t and p["guilty"]["pass"] == "02_draw_96x96"|uniform'
    '"shift of " in w|shader'
    'p["guilty"]["pass"] == "01_draw_96x96" and "flip in y" in w|rows'
    '"vertex data spot: 1 of 12 numbers differ, by up to 0.1" in t and "vertex data indices: 2 of 6 numbers" in t|vertices'
    '"clampedge/clampedge, channels green/green/blue/alpha" in t|channels'
    '"clear of colour: (0.1, 0.2, 0.3, 1) against (0.1, 0.4, 0.3, 1)" in t and "clear of stencil: 0 against 1" in t|clear'
    '"Light.tint: (1, 1, 1, 1) against (1, 0.5, 1, 1)" in t|block' '"rasterizer discard: off against on" in t|discard'
    '"(0.1, 0.2, 0.3, 1) against (0.1, 0.4, 0.3, 1)" in t|before' '"1 against 2 draws" in t and "less against greater (in all draws)" in t|parts'
    '"alpha add(one, zero)" in t and len(p["captures"]["matched"]) == 4|alpha' '"blurred: the picture of 01_draw_96x96 against that of 00_" in t|read'
    '{"00.still"} <= b and [r["mip"] for r in p["results"] if r["resource"] == "still"] == [0, 1]|levels')
mapfile -t faults < <(drawn 9 "${faults[@]}")
judged . "OpenGL against OpenGL" "${faults[@]}"
check "another moment is told before the passes" grep -Pzq 'not the same moment: iTime: 0.22 .*\n.*\npass ' "$work/said"
says 1 'draw 96x96 first half .* draw 96x96 first half' cover.rdc covered.rdc --json all.json >"$work/output"
check "targets of all kinds differ where they are wrong: samples, a layer, all layers, a face, a mip, a slice, shared memory" pair 0 \
    '{"01.color0", "03.color0", "05.color0", "09.color0", "14.color0", "19.color0", "22.color0"} <= b and not b & {"21.color0", "23.color0"}'
check "... mips that are made, a resolve, an image, buffers that a shader reads and writes" pair 0 \
    '"groups (12, 12, 1) against (12, 11, 1)" in t and "alpha to coverage: off against on" in t and
    {"24.color0", "25.color0", "26.picture", "26.Sums", "26.Keys"} <= b and not b & {"02.color0", "08.color0", "13.color0", "18.color0"}'
confined=1 check "state stands beside the first difference" says 1 '^beside it, in the state of 00_.*: cull: nocull against back$' \
    none.rdc cull.rdc --save saved --html page
check "... and on the page" grep -q 'cull: nocull against back' page/index.html
check "the shaders of the pass are saved" grep -q 'uniform mat4 place' saved/first/vertex.glsl
check "the pass alone shows that its shader is not the cause" grep -q '^alone, .* picture of first and second: .* outside the shader; what differs: cull$' said
check "... in a spec that runs" "$diptych" compare --spec saved/second/alone/alone.yaml
check "... or that its code is" says 1 '^alone, .* agree, .*: the cause is the code of the shader' none.rdc shader.rdc --match match.json

sed -i '/"second": 2/,/rows/ s/"same"/"opposite"/' match.json
check "a matching is read as it was corrected" says 1 '^02_draw_96x96 .* opposite' none.rdc rows.rdc --match match.json
echo '{"passes": [{"first": 0, "second": 9, "rows": "same"}]}' >wrong.json
check "... but not with passes that are not there" says 2 'wrong.json: passes 0 and 9' none.rdc rows.rdc --match wrong.json
check "the draws of a pass are compared" says 1 '^first pass that differs: 00_draw_96x96' none.rdc cull.rdc --draws 00
check "... of one that is there" says 2 '--draws 17: no pass' none.rdc cull.rdc --draws 17
check "noise of runs is measured" says 1 'depth: breaks its contract in some runs' none.rdc,none.rdc none.rdc,offset.rdc --measure 2

# ---- The same across APIs: Zink draws OpenGL with Vulkan --------------------------------------------------------------

across=('p["agree"] and t == "{}"|none' '"depth test: less against greater" in t|depth' '"blend: " in t|blend'
    '"cull: nocull against back" in t|cull' '"factor 0.5, units 0 against factor 0, units 1" in t|offset' '"scissor: whole against (0, 0, 50, 96)" in t|scissor'
    '"viewport: (0, 0, 96, 96) against (8" in t|viewport' '"clampedge/clampedge against linear/linear, wrap" in t|wrap'
    '"8 bits unorm against 16 bits float" in t|format' '"shift of 2 texels" in w|shader'
    '"flip in y" in w|rows' '"exposure: 1 against 1.25" in t|uniform' '"(0.1, 0.2, 0.3, 1) against (0.1, 0.4, 0.3, 1)" in t|clear'
    '"Light.tint: (1, 1, 1, 1) against (1, 0.5, 1, 1)" in t|block' 'len(p["captures"]["matched"]) == 3|pass')
mapfile -t across < <(drawn 6 "${across[@]}")
if frames vk ENABLE_VULKAN_RENDERDOC_CAPTURE=1 GALLIUM_DRIVER=zink /usr/bin/python3 -B "$scene" "${across[@]##*|}" cover covered; then
    echo "# SEED=$seed: faults ${faults[*]##*|}; ${across[*]##*|}"
    judged vk "OpenGL against Vulkan" "${across[@]}"
    says 1 'first half to second half .* draw 96x96 ' cover.rdc vk/cover.rdc vk/covered.rdc --json all.json >"$work/output"
    tap_result $? "... labels of one side alone part no run"
    check "... targets of all kinds are equal, but cubes, of which Zink makes 36 layers, and slices before all are drawn" \
        pair 0 'b <= {"16.color0", "17.color0", "18.color0"} and len(p["captures"]["matched"]) == 24'
    check "... or differ; the state of draw 38 of 100 is told" pair 1 '"blend: off" in t and "(draw 38 of 100)" in t and
        {"02.color0", "04.color0", "13.color0", "21.color0", "23.color0", "24.color0", "25.picture", "25.Sums", "25.Keys"} <= b'
    check "... samples that RenderDoc cannot read are told" grep -q 'vk/cover.rdc: of 1 passes, single samples, .* left out' said
    confined=1 check "... a depth test is no shader's fault" \
        says 1 '^alone, .* picture of gl and vk: .* outside the shader, or .*; what differs: depth test$' none.rdc vk/depth.rdc
    check "a program whose OpenGL Zink draws is captured as Vulkan" timeout 120 "$diptych" capture -o zink.rdc --frame 3 \
        --env GALLIUM_DRIVER=zink -- /usr/bin/python3 -B "$scene"
    check "... with its window" says 0 ' screen .* equal ' once.rdc zink.rdc
else
    cd "$work" || exit 1
    skip "faults across APIs" "no Zink that RenderDoc captures"
fi

# ---- What is wrong ----------------------------------------------------------------------------------------------------

head -c 30000 once.rdc >cut.rdc
{ head -c 9000 once.rdc && seq 2000 | head -c 5000 && tail -c +14001 once.rdc; } >damaged.rdc
confined=1 check "a capture that is cut off ends with a message" says 2 'error: cut.rdc: ' cut.rdc none.rdc
confined=1 check "... and a damaged one" says 2 'error: damaged.rdc: ' damaged.rdc none.rdc --html x.rdc
check "... and a folder beside it" says 2 'captures are compared with captures' none.rdc .
check_status 1 "a program that ends is told" "$diptych" capture -o x.rdc --frame 3 -- /bin/true
check_status 1 "... and one that is not there" "$diptych" capture -o x.rdc -- no-such-program
check_status 2 "... and none" "$diptych" capture -o x.rdc
fixed='import ctypes; gl, glfw = map(ctypes.CDLL, ("libGL.so.1", "libglfw.so.3")); new = glfw.glfwCreateWindow; new.restype = ctypes.c_void_p
glfw.glfwInit(); window = ctypes.c_void_p(new(64, 64, b"", None, None)); glfw.glfwMakeContextCurrent(window)
while not (gl.glBegin(4), gl.glEnd(), glfw.glfwSwapBuffers(window))[2]: pass'
check "... and one with fixed function" bash -c "! '$diptych' capture -o x.rdc --after 1 -- /usr/bin/python3 -c '$fixed' 2>&1 | grep -v 'capture its OpenGL: .*: glBegin, glEnd; '"
check "nothing is left of them" test ! -e x.rdc
check "a replay that was taken over names its own files alone, and is told where it left no frame" env PYTHONPATH="$root/app/python" /usr/bin/python3 -c '
import os
from diptych.rdc.left import FRAME, Unreadable, own, read
os.makedirs("left/below"), os.symlink("/etc/passwd", "left/link"), open("left/own", "w").close()
def frame(text):
    with open("left/frame.json", "wb") as file:
        file.write(text)
    read("left", FRAME)
own("left", "own")
for call, *wrong in ((lambda name: own("left", name), "/etc/passwd", "../none.rdc", "below", "below/../own", "./own", "link", "absent", ""),
                     (frame, b"{", b"\xff", b"[]", b"[" * 100000, b"{\"passes\": [3]}")):
    for item in wrong:
        try:
            call(item)
        except Unreadable:
            continue
        raise SystemExit(f"{item[:20]} was taken")'
check "a fault of our own is called so" env PYTHONPATH="$root/app/python" /usr/bin/python3 -c '
import io, sys
from contextlib import redirect_stderr
import diptych.__main__ as program, diptych.rdc.compare as verb
verb.Comparison, sys.argv[1:], sys.stdin = None, ["compare"], io.TextIOWrapper(io.BytesIO(b"{\"errors\": []}"))
with redirect_stderr(io.StringIO()) as told:
    status = program.main()
raise SystemExit(not (status == 2 and "Traceback" in told.getvalue() and "internal error: TypeError" in told.getvalue()))'

check "a replay that shows another picture proves nothing; one backend alone is blamed" env PYTHONPATH="$root/app/python" /usr/bin/python3 -c '
import io, os
import numpy as np
from contextlib import redirect_stdout
from types import SimpleNamespace
from unittest import mock
from diptych.rdc import replays
from diptych.rdc.replay import FLAGS, Grouping
from diptych.rdc.state import restarts, sampler, sampler_of
from diptych.rdc.texels import KINDS, TYPES, texels_of
from diptych.rdc.capture import is_ours
from diptych.rdc.differ import aligned, alone, blit, common, in_order, state_texts, uniform_differences, worded
from diptych.rdc.compare import Matched, drop_alpha
from diptych.rdc.guilty import modern, verdict
from diptych.rdc.match import Matcher, Pair, Side
whole = [{"kind": "draw", "entries": [{"samples": 4}], "left_out": ["color0"]}, {"kind": "resolve", "entries": ["resolved"]}]
(side := Side("", "", "", {"passes": whole})).leave_samples()
assert side.passes == [{"kind": "draw", "entries": ["resolved"], "left_out": []}]
draws = SimpleNamespace(draws={"00_draw": [6, 100], "01_draw": [1, 1]})
assert Matched.draws_text(draws) == "state of 7 of 101 draws compared: 6 of 100 in 00_draw; --draws compares all of a pass"
assert aligned([[18, 1], [9, 1], [30, 1], [60, 1], [9, 1]], [[9, 2], [9, 1], [60, 1], [30, 1]]) == [(0, 0), (1, 1)]
assert aligned([[9, 1], [9, 1], [30, 1], [6, 1]], [[18, 1], [30, 1], [6, 1]]) == [(0, 0), (2, 1)]
lacking = [[[6, 1], [99, 1], [6, 1], [30, 1], [60, 1]], [[6, 1], [60, 1], [6, 1], [30, 1]]]
assert aligned(*lacking) == [(3, 3), (4, 1)] and alone(lacking, [(3, 3), (4, 1)]).startswith("; in the first alone: draw 1 (6 vertices), 2 (99 vertices), 3 (6")
sides = [{"counts": [[6, 1]] * 2, "states": [{"draw": at, "streams": {"a": name}, "uniforms": {}, "samplers": {}} for at, name in enumerate(names)]}
         for names in ("xy", "yx", "xz")]
assert [in_order(sides[0], side) for side in sides] == [[(0, 0), (1, 1)], [(0, 1), (1, 0)], [(0, 0), (1, 1)]]
assert state_texts({"depth format": "d24s8"}, {}) == [] and is_ours(os.getppid()) is False and is_ours(os.getpid())
row = [1, 2, 3, 4, 5, 6, 7, 8]
turned, matrices = [*row[:4], *(-number for number in row[4:])], {"HLSL": [[1, 5, 2, 6, 3, 7, 4, 8], 2]}
assert uniform_differences({"HLSL": row, "flat": row}, {**matrices, "flat": turned}) == []
assert [name for name, _ in uniform_differences({"HLSL": row, "flat": row}, {"HLSL": matrices["HLSL"][0], "flat": row[::-1]})] == ["HLSL", "flat"]
seen = np.array([[2, 0, 0, 1], [0, 3, 1, 0], [0, 1, -1, -2], [0, 0, -1, 0]])
clips = [np.linalg.inv(clip @ seen).ravel().tolist() for clip in (np.eye(4), np.array([[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, .5, .5], [0, 0, 0, 1]]))]
assert uniform_differences({"inverse": clips[0]}, {"inverse": clips[1]}) == []
def words(*numbers):  # that Zink leaves
    return {"uniforms": {f"pixel uniform_0[{at}]": [number] for at, number in enumerate(numbers)}}
loose = {"uniforms": {"a": [1.0], "b": [2.5, 3.0], "c": [-7], "d": [1]}, "loose": {"pixel": ["a", "b", "c", "d"]}, "laid": {}}
for own, changed, lost in ((words(1.0, 2.5, 3.0, 2**32 - 7, 2**32 - 1, 1.0), [], []), (words(2.5, 3.0, 2**32 - 7, 1.0, 1), [], []),
                           (words(1.0, 2.5, 4.0, 2**32 - 7, 1), ["b"], []), (words(2.5, 3.0, 2**32 - 7, 5.0, 1), [], ["a"])):
    found, gone = worded(loose, own)
    assert ([name for name, _ in uniform_differences({name: loose["uniforms"][name] for name in found}, found)], gone) == (changed, lost), own
assert common({"s_tex": 1}, {"s_texTexture": 2}) == [("s_tex", 1, 2)]
assert common({"_25.turn": 1, "_11.turn": 1, "_25.a": 1, "_11.a": 2}, {"turn": 1, "a": 1}) == [("turn", 1, 1)]
restarting = SimpleNamespace(IsRestartEnabled=lambda: True, GetRestartIndex=lambda: 0xffffffff)
assert restarts(restarting, np.array([0, 0xffff, 0xfffe], "u2")).tolist() == [False, True, False]
form = SimpleNamespace(type=TYPES.Regular, compType=KINDS.Depth, compByteWidth=4)
assert texels_of(form, b"\xff" * 4, 1, 1, True).rows == 0xffffff and texels_of(form, b"\0\0\x80\x3f", 1, 1, True).rows == 1
form = SimpleNamespace(type=TYPES.Regular, compType=KINDS.UScaled, compByteWidth=1, compCount=1)
assert texels_of(form, b"\x07", 1, 1, True).rows == 7
region = [[0, 0, 9, 9], [0, 0, 6, 6], [1], [9, 8]]
assert blit(region, False, False) == "(0, 0, 9, 9) to (0, 0, 6, 6), linear" == blit([[0, 9, 9, 0], [0, 8, 6, 2], [1], [9, 8]], True, True)
inputs = [[{"resource": name, "kind": "image", "file": file, "turned": file, "width": 1, "height": 1, "layers": 1, "format": "rgba8", "id": file}
           for name, file in zip(names, "xy")] for names in ("ab", "ba")]
small = {name: np.zeros((1, 1, 4)) for name in "xy"}
swapped = Matcher(*(Side("", "", "", {"small": small, "passes": [{"entries": [1], "inputs": items}]}) for items in inputs))
swapped.pair_inputs(pairs := [Pair(0, 0)])
assert [one["resource"] + other["resource"] for one, other, _ in pairs[0].inputs] == ["aa", "bb"]
blocks = [[{"resource": "tex", "kind": "buffer", "file": name, "turned": name, "count": 4, "id": name} for name in names] for names in ("pqr", "rst")]
small.update((name, np.zeros(4)) for name in "pqrst")
Matcher(*(Side("", "", "", {"small": small, "passes": [{"entries": [1], "inputs": items}]}) for items in blocks)).pair_inputs(pairs := [Pair(0, 0)])
assert [one["file"] + other["file"] for one, other, _ in pairs[0].inputs] == ["rr"]
assert modern("#version 120\nvarying vec2 p; x(texture2DProj); gl_FragColor") == (
    "#version 330\nout vec4 alone_color;\n\nin vec2 p; x(textureProj); alone_color")
place = [SimpleNamespace(bind=at, bindset=0, used=True) for at in range(2)]
reads = SimpleNamespace(GetBindpointMapping=lambda _: SimpleNamespace(samplers=place), GetShaderReflection=lambda _: SimpleNamespace(
    samplers=[SimpleNamespace(name=name, bindPoint=at) for at, name in enumerate(("noise", "s_tex_sampler"))]))
assert sampler_of(reads, None, [SimpleNamespace(bindings=[SimpleNamespace(binds=[at]) for at in "ab"])], "s_tex") == "b"
item = SimpleNamespace(filter=SimpleNamespace(minify="Anisotropic", magnify="Linear", mip="Linear", filter="Normal"), minLOD=0, maxLOD=9, maxAnisotropy=4)
seen = SimpleNamespace(firstMip=0, numMips=1, swizzle=SimpleNamespace(red="Red", green="Green", blue="Blue", alpha="Alpha"))
assert sampler(item, seen, ["repeat"], None, None) == "linear/linear, repeat, anisotropy 4"
kinds, textures = [], {at: SimpleNamespace(mips=1, msSamp=at) for at in (1, 4, 9)}
copies = SimpleNamespace(untold={}, textures=textures, buffers={}, current=None, alone=lambda kind, *_: kinds.append(kind))
for source in (1, 4):
    Grouping.copy(copies, SimpleNamespace(copyDestination=9, copySource=source, flags=FLAGS.Resolve, eventId=0), [])
assert kinds == ["blit", "resolve"], kinds
alone = [{"index": at, "kind": "draw", "where": [], "entries": []} for at in range(12)]
many = SimpleNamespace(clocks={}, state={}, labels="ab", sides="ab", pairs=[], doubled=False, both=lambda: iter(()), alone=lambda _: alone)
with redirect_stdout(io.StringIO()) as told:
    Matched.tell(many)
assert told.getvalue().count("only in a") == 9 and "only in b: 4 more passes" in told.getvalue(), told.getvalue()
open("frame.json", "w").close()
for statuses, tries, words in (((-11, 0), 2, ""), ((-9, 0), 1, "signal 9"), ((139, 139), 2, "signal 11")):
    ends = iter(statuses)
    process = SimpleNamespace(stderr=[], wait=lambda: next(ends), kill=str, send_signal=str)
    with mock.patch.object(replays.subprocess, "Popen", return_value=process) as started:
        why = replays.replay(None, False, "replay", "x.rdc", ".", "")
    assert words in why and bool(why) == bool(words) and started.call_count == tries, (statuses, why)
chains = [{"kind": "mips", "where": "", "states": [], "draws": 1, "counts": [], "entries": [{"kind": "image", "mip": mip, "width": side >> mip, "height": side >> mip,
    "layers": 1, "screen": False, "resource": "color0", "file": "", "turned": ""} for mip in range(3)]} for side in (8, 8, 4)]
empty = Side("", "", "", {"passes": []})
assert [Matcher(empty, empty).score(*pair)[1] > 0 for pair in (chains[:2], chains[1:])] == [True, False]
open("window", "wb").write(bytes(range(8)))
window = {"screen": True, "width": 2, "file": "window", "format": "bgra8_srgb"}
drop_alpha([Side(".", "", "", {})] * 2, ({**window, "format": "rgb8"}, window))
assert window["format"] == "rgb8_srgb" and open(window["file"], "rb").read() == bytes([2, 1, 0, 6, 5, 4])
ramp = np.linspace(0, 1, 256, dtype="f4").reshape(8, 8, 4)
def told(gl, vk):  # what both backends leave, of sides that are .2 apart
    sides = [SimpleNamespace(label=label, why="", own=[ramp + own], ours={"gl": [ramp + own + gl], "vk": [ramp + own + vk]},
                             made={"left": [], "textures": [], "shader": label}, source="") for label, own in (("a", 0), ("b", 0.2))]
    return verdict(sides, True, False, ["cull: none against back"])
for words, gl, vk in (("or its code is not the same; what differs: cull", 0, 0.001), ("does not show the picture of a: 64 of 64 texels", 0.1, 0.1),
                      ("differ, too: 64 of 64 texels", 0.0, 0.1), ("differ, too: 64 of 64 texels", 0.1, 0.0)):
    if words not in told(gl, vk):
        raise SystemExit(told(gl, vk))'

# ---- Programs of packages ---------------------------------------------------------------------------------------------

{ printf 'P6 160 96 255\n' && seq 20000 | head -c 46080; } >ramp.ppm
film() { # api more...
    local api=$1
    shift
    captured "mpv_$api.rdc" 4 mpv --no-config --vo=gpu-next --gpu-sw --gpu-api="$api" "$@" --image-display-duration=0.2 --no-audio --osc=no \
        --osd-level=0 --loop=inf --really-quiet --geometry=160x96 ramp.ppm
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

# ---- Large programs, in long runs -------------------------------------------------------------------------------------

large() { # API, option of `capture`, command...
    HOME=$work QSG_RHI_BACKEND=$1 timeout 200 "$diptych" capture -o "large_$1.rdc" "${@:2}"
}
cat >three.qml <<'END'
import QtQuick
import QtQuick3D
Window { visible: true; width: 160; height: 96
    View3D { anchors.fill: parent
        environment: SceneEnvironment { backgroundMode: SceneEnvironment.Color; clearColor: "gray"; aoStrength: 100; aoDistance: 40; aoSoftness: 20 }
        PerspectiveCamera { position: "0,100,300"; eulerRotation.x: -18 }
        DirectionalLight { eulerRotation.x: -40; castsShadow: true }
        Model { source: "#Cube"; scale: "2,.2,2"; materials: PrincipledMaterial { } }
        Model { source: "#Sphere"; y: 50; materials: PrincipledMaterial { baseColor: "tan" } }
        Model { source: "#Cube"; y: 9000; materials: DefaultMaterial { } NumberAnimation on x { to: 1; loops: Animation.Infinite; duration: 90000 } } } }
END
if [ -z "${DIPTYCH_LONG:-}" ]; then
    : # they take minutes
elif [ -n "$qml" ] && [ -x /usr/games/warzone2100 ] && [ -e "$(find /usr/lib -path '*/qml/QtQuick3D/qmldir' -print -quit)" ]; then
    for api in opengl vulkan; do check "Qt Quick 3D is captured with $api" large "$api" --frame 10 -- "$qml" three.qml; done
    check "... and its ambient occlusion alone differs on both sides alike" says 1 '^alone, with equal inputs, gl and vk agree' large_{opengl,vulkan}.rdc
    for api in opengl vulkan; do
        check "Warzone 2100 is captured with $api" large "$api" --after 20 -- /usr/games/warzone2100 --window --resolution=640x480 \
            --nosound --game=CAM_1A "--gfxbackend=$api"
    done
    check "... and its polygon offset is told" says 1 'factor and units are swapped' large_{opengl,vulkan}.rdc
else
    skip "large programs" "warzone2100 or qml6-module-quick3d is not installed"
fi
finish
