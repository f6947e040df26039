#!/usr/bin/env bash
# compare on the command line: its last line, exit status and JSON for agreement, for a fault in either side, and for inputs that
# it refuses. Compares whole and damaged dumps with the backends here. An interrupted comparison leaves no process. TAP.
. "$(dirname "$0")/../lib/tap.sh"
cd "$root" || exit 1
scene=scenes/cornell.yaml
spec=tests/specs/features.yaml
features=("$diptych" compare --scene "$scene" --spec "$spec" --size 17x9)
agreement="all 20 resources of 12 passes agree"

ends() { # status last-line command...: exactly that line closes stdout
    local want=$1 line=$2 got
    shift 2
    "$@" >"$work/table" 2>"$work/said" </dev/null
    got=$?
    cat "$work/said" "$work/table"
    echo "exit status $got, expected $want, ending with: $line"
    [ "$got" = "$want" ] && [ "$(tail -n 1 "$work/table")" = "$line" ]
}

refuses() { # text command...: one error, which contains the text, no table, and exit status 2
    local text=$1 got
    shift
    "$@" >"$work/table" 2>"$work/said" </dev/null
    got=$?
    cat "$work/said" "$work/table"
    echo "exit status $got, expected 2, with: $text"
    [ "$got" = 2 ] && [ "$(grep -c 'error:' "$work/said")" = 1 ] && grep -qF -- "$text" "$work/said" && [ ! -s "$work/table" ]
}

holds() { # python: an expression about `it`, the JSON
    /usr/bin/python3 -c "import json, sys; it = json.load(open('$work/it.json')); sys.exit(not ($1))" || { cat "$work/it.json"; false; }
}

says() { # pattern: a line of the last table
    grep -E -- "$1" "$work/table" || { cat "$work/table"; false; }
}

# ---- Agreement ---------------------------------------------------------------------------------------------------------

check "OpenGL and Vulkan agree" ends 0 "$agreement" "${features[@]}" --json "$work/it.json"
check "... the JSON says so of every row" holds "it['agree'] is True and it['first_break'] is None and it['guilty'] is None \
    and it['sides'] == ['gl', 'vk'] and set(it['devices']) == {'gl', 'vk'} and len(it['results']) == 20 \
    and all(r['verdict'] == 'equal' and r['differing'] == 0 and r['elements'] > 0 for r in it['results']) \
    and it['pipeline'] == 'features' and (it['width'], it['height'], it['frames']) == (17, 9, 1)"
check "... and nothing was run again" holds "not any('own_error' in r for r in it['results'])"
# Each run of the Vulkan backend is a process that makes a Vulkan instance; the loader's messages show how many.
runs_vulkan() { # times option...
    local times=$1
    shift
    VK_LOADER_DEBUG=layer "$diptych" "${features[@]:1}" "$@" >"$work/table" 2>"$work/loader"
    [ "$(grep -c 'vkCreateInstance layer callstack' "$work/loader")" = "$times" ] || { grep vkCreate "$work/loader"; false; }
}
check "... nor was Vulkan started again" runs_vulkan 1
diptych=$planted check "which it is where they differ" runs_vulkan 2 --fault vk:compose:bit
check "a backend agrees with itself" ends 0 "$agreement" "${features[@]}" --backend vk,vk --json "$work/it.json"
check "... under two names" holds "it['sides'] == ['vk', 'vk#2'] and len(it['devices']) == 2"
check "four sides agree" ends 0 "$agreement" "${features[@]}" --backend gl,vk@0,osmesa,gl+glsl --json "$work/it.json"
check "... in three pairs" holds "[p['sides'] for p in it['pairs']] == [['gl', s] for s in ('vk@0', 'osmesa', 'gl+glsl')] \
    and all(p['agree'] and len(p['results']) == 20 for p in it['pairs']) and it['agree'] and 'results' not in it"

pairs=4 zink=,zink
if ! compgen -G '/usr/lib/*/dri/zink_dri.so' >/dev/null; then
    pairs=3 zink=
    skip "the shipped pipelines agree with OpenGL over Vulkan" "no /usr/lib/*/dri/zink_dri.so: install libgl1-mesa-dri"
fi
for pipeline in rsm ${DIPTYCH_LONG:+ssvp}; do
    # shellcheck disable=SC2016
    check "$pipeline agrees in five ways: two forms of OpenGL, OSMesa, OpenGL over Vulkan, Vulkan" bash -c '"${@:2}" | grep -Fx "$1 pairs agree"' - $pairs \
        "$diptych" compare --scene $scene --spec "templates/$pipeline.yaml" --size 37x23 --set rsm_size=128 \
        --backend gl,gl+glsl,osmesa$zink,vk
done

# ---- Blame -------------------------------------------------------------------------------------------------------------

check "a fault in Vulkan is blamed on its pass" \
    ends 1 "guilty: pass blur (shader features_blur.glsl): resource blurred, in frame 0" \
    "$planted" "${features[@]:1}" --fault vk:blur:bit --json "$work/it.json"
check "... one element of its own" says '^blur +blurred +153 +1 +DIFFERS +equal +1 differ +[0-9.e-]+ at \([0-9]+, [0-9]+\)\.[rgba], frame 0: gl [^ ]+ \(0x[0-9a-f]{4}\), vk '
check "... inherited by what reads it" says '^compose +hdr +153 +1 +DIFFERS +differ +none '
check "... which is in the JSON, too" holds "it['agree'] is False \
    and it['guilty'] == {'pass': 'blur', 'resource': 'blurred', 'frame': 0, 'shader': 'features_blur.glsl'} \
    and it['first_break'] == {'pass': 'blur', 'resource': 'blurred', 'frame': 0} \
    and {r['resource']: (r['inputs'], r['own_error']['differing']) for r in it['results'] if r['verdict'] != 'equal'} \
        == {'blurred': ('equal', 1), 'hdr': ('differ', 0)}"
check "a fault in OpenGL, the first side, is blamed on its pass" \
    ends 1 "guilty: pass scene (shader features_scene.glsl): resource color, in frame 0" \
    "$planted" "${features[@]:1}" --fault gl:scene:missing
check "a fault in what a later frame makes of the one before" \
    ends 1 "guilty: pass follow (shader features_follow.glsl): resource trail, in frame 1" \
    "$planted" "${features[@]:1}" --frames 3 --fault vk:follow:texel@1 --json "$work/it.json"
check "... counted in one frame, not over all" holds "[(r['elements'], r['frames_differing']) for r in it['results'] \
    if r['resource'] == 'trail'] == [(153, 2)] and all(r['differing'] <= r['elements'] for r in it['results'])"
check "a fault that nobody reads is found" \
    ends 1 "guilty: pass show (shader features_show.glsl): resource shown, in frame 0" "$planted" "${features[@]:1}" --fault vk:show:sign
check "of three sides, the pair that differs is told" \
    ends 1 "guilty: pass lacing (shader features_lace.glsl): resource laced, in frame 0" \
    "$planted" "${features[@]:1}" --backend gl,vk,osmesa --fault osmesa:lacing:sign --json "$work/it.json"
check "... and the other agrees" holds "[p['agree'] for p in it['pairs']] == [True, False] and it['agree'] is False \
    and it['pairs'][0]['guilty'] is None and it['pairs'][1]['guilty'] == it['guilty'] and it['guilty']['pass'] == 'lacing'"

# ---- Dumps -------------------------------------------------------------------------------------------------------------

render=("$diptych" render --scene "$scene" --spec "$spec" --size 17x9)
here=("$diptych" compare --scene "$scene" --spec "$spec")
check "a dump of Vulkan's third frame" "${render[@]}" --backend vk --frames 3 --set weight=0.5 --dump "$work/dump"
check "... agrees with OpenGL, in its size, frame and live parameters" \
    ends 0 "$agreement" "${here[@]}" --backend gl --against "$work/dump" --json "$work/it.json"
check "... of that size" holds "(it['width'], it['height'], it['frames']) == (17, 9, 3) and it['sides'] == ['dump', 'gl'] \
    and [r['elements'] for r in it['results'] if r['resource'] == 'shown'] == [153]"
check "... and with both backends" ends 0 "$agreement" "${here[@]}" --against "$work/dump"

damaged() { # python: damages a copy of the dump, in the folder `d` with the manifest `m`
    rm -rf "$work/damaged" && cp -r "$work/dump" "$work/damaged" && /usr/bin/python3 - "$work/damaged" <<PYTHON
import glob, json, os, sys
d = sys.argv[1]
m = json.load(open(d + '/manifest.json'))
def flip(name):
    path, = glob.glob(d + '/' + name)
    data = bytearray(open(path, 'rb').read())
    data[len(data) // 2] ^= 1
    open(path, 'wb').write(data)
$1
json.dump(m, open(d + '/manifest.json', 'w')) if m is not None else None
PYTHON
}
while read -r file pass shader resource; do
    damaged "flip('$file')"
    check "a flipped bit in $file is blamed on $pass" \
        ends 1 "guilty: pass $pass (shader $shader): resource $resource, in frame 2" \
        "${here[@]}" --backend vk --against "$work/damaged"
done <<'END'
00.scene.label.raw scene features_scene.glsl label
04.count.histogram.raw count features_count.glsl histogram
09.remember.memory.raw remember features_remember.glsl memory
11.show.shown.raw show features_show.glsl shown
END
damaged "flip('history.memory.raw')"
check "a flipped bit in what the frame found is told, and the pass that cannot have made its output of that" \
    ends 1 "guilty: pass remember (shader features_remember.glsl): resource memory, in frame 2" \
    "${here[@]}" --backend vk --against "$work/damaged" --json "$work/it.json"
check "... and stands before the passes" says '^before +memory +4 +1 +DIFFERS '
check "... in the JSON, too" holds "it['first_break'] == {'pass': None, 'resource': 'memory', 'frame': 2} \
    and {r['resource']: r['differing'] for r in it['history']} == {'memory': 1, 'trail': 0} and it['agree'] is False"

# shellcheck disable=SC2016 # these are no commands
while IFS='|' read -r what text; do
    damaged "$what"
    check "a dump with $what is refused" refuses "$text" "${here[@]}" --backend gl --against "$work/damaged"
done <<'END'
open(d + '/06.blur.blurred.raw', 'ab').truncate(100)|06.blur.blurred.raw: has 100 bytes instead of 1224: the folder is damaged
open(d + '/06.blur.blurred.raw', 'ab').write(b'x')|06.blur.blurred.raw: has 1225 bytes, more than 1224
os.remove(d + '/08.follow.trail.raw')|08.follow.trail.raw: cannot be read: No such file or directory
os.remove(d + '/history.trail.raw')|history.trail.raw: cannot be read: No such file or directory
os.remove(d + '/manifest.json'); m = None|manifest.json: cannot be read: No such file or directory
open(d + '/manifest.json', 'w').write('{"entries": ['); m = None|manifest.json: is no JSON
m = [1, 2]|manifest.json: is no manifest of a dump; render --dump makes one
del m['entries'][3]|manifest.json: names no file for depth after pass scene
m['history'] = []|manifest.json: names no file for memory before pass scene
m['entries'][0]['file'] = '../dump/00.scene.color.raw'|00.scene.color.raw: cannot be read: is outside the folder
m['entries'][0]['format'] = 'rgba16f'|manifest.json: "format" of color after pass scene is not the pipeline's
[e for e in m['entries'] if e['resource'] == 'histogram'][0]['fields'][0]['offset'] = 4|manifest.json: "fields" of histogram after pass count is not the pipeline's
m['entries'][0]['width'] = 16|manifest.json: "width" of color after pass scene is not the pipeline's
m['pipeline'] = 'ssvp'|holds the pipeline ssvp, this is features; name its --spec
m['diptych'] = '0.0.1'|holds another features: diptych 0.0.1 made it, this is
m['sources'][0]['hash'] = '0'|holds another features: features.yaml has other content; the spec, its GLSL, --set
[f for f in m['sources'] if f['file'] == 'glsl/filter.glsl'][0]['hash'] = '0'|holds another features: glsl/filter.glsl has other content
m['sources'].pop()|holds another features: it reads glsl/
m['params']['bins'] = 17|holds another features: bins is 17 there, 16 here
m['set'] = ['exactness=fast']|holds another features: --set ["exactness=fast"] there, [] here
m['scene_file'] = '0'|was made of scenes/cornell.yaml, and scenes/cornell.yaml has other content
del m['sources']|says no "sources"; make the dump again with this diptych
del m['live']['weight']|says no value of the live parameter weight
m['live']['weight'] = 7|--set weight=7: must be of type float, from 0 to 1
m['width'] = -1|"width" is missing or no whole number; make the dump again with this diptych
END
damaged "m['scene_data'] = '0'"
check "a mesh with other bits is told" bash -c '"$@" 2>&1 | grep -F "warning: --against"' - "${here[@]}" --backend gl --against "$work/damaged"

against=("${here[@]}" --backend gl --against "$work/dump")
check "another size is refused" refuses "--size 16x9: $work/dump holds a frame of 17x9" "${against[@]}" --size 16x9
check "another frame is refused" refuses "--frames 2: $work/dump holds the last of 3 frames" "${against[@]}" --frames 2
check "another live parameter is refused" refuses "--set weight=0.25: $work/dump was made with 0.5" "${against[@]}" --set weight=0.25
check "the same one is not" ends 0 "$agreement" "${against[@]}" --set weight=0.5 --size 17x9 --frames 3
check "another parameter is refused" refuses "holds another features: bins is 16 there, 17 here" "${against[@]}" --set bins=17
check "the same one is not" ends 0 "$agreement" "${against[@]}" --set bins=16
check "another key of the spec is refused" refuses 'holds another features: --set [] there, ["images.label.clear=8"] here' \
    "${against[@]}" --set images.label.clear=8
mkdir "$work/elsewhere" && cp tests/specs/features* "$work/elsewhere"
elsewhere=("$diptych" compare --scene "$scene" --spec "$work/elsewhere/features.yaml" --backend gl --against "$work/dump")
check "the same spec in another folder is not" ends 0 "$agreement" "${elsewhere[@]}"
echo '// an edit' >>"$work/elsewhere/features_show.glsl"
check "... edited, it is" refuses "holds another features: features_show.glsl has other content" "${elsewhere[@]}"
check "another scene is refused" refuses "was made of $scene, and scenes/atrium.yaml has other content" \
    "$diptych" compare --scene scenes/atrium.yaml --spec $spec --backend gl --against "$work/dump"

# ---- What cannot be compared -------------------------------------------------------------------------------------------

check "one backend alone" refuses "a comparison needs two sides" "${features[@]}" --backend vk
check "a slip of the pen" refuses 'unknown backend "zinc"; did you mean "zink"?' "${features[@]}" --backend gl,zinc
check "an empty entry" refuses "must be names with one comma between" "${features[@]}" --backend gl,,vk
check "Vulkan takes no GLSL" refuses "only OpenGL takes GLSL text" "${features[@]}" --backend gl,vk+glsl
check "OpenGL takes no device" refuses "only vk takes a device" "${features[@]}" --backend gl@0,vk
check "a device for nobody" refuses "--device 0: --backend names no side that takes a device" \
    "${features[@]}" --backend gl,osmesa --device 0
check "a device that is not there" refuses "vk@none: no Vulkan device is called \`none\`" "${features[@]}" --backend gl,vk@none
printf 'pipeline: nothing\npasses:\n  - {name: idle, dispatch: [1, 1, 1], shader: idle.glsl}\n' >"$work/nothing.yaml"
echo 'void main() {}' >"$work/idle.glsl"
check "a pipeline that writes nothing" refuses "nothing: no pass writes anything: nothing to compare" \
    "$diptych" compare --scene $scene --spec "$work/nothing.yaml" --size 8x8
strays() { # tries ten times, as a race changes the result only now and then
    for _ in $(seq 10); do
        "$diptych" compare --scene "$scene" --spec tests/specs/racing.yaml --size 64x64 --backend gl,gl >"$work/table" 2>&1
        tail -n 1 "$work/table" | grep -E "^(gl|gl#2) is not repeatable: pass [a-z_]+ wrote another [a-z_]+ when it ran again, in frame 0$" && return
    done
    cat "$work/table"
    return 1
}
check "a pipeline that is not the same twice" strays

# ---- Pages -------------------------------------------------------------------------------------------------------------

rsm=("$diptych" compare --scene "$scene" --spec templates/rsm.yaml --size 15x9 --set rsm_size=16 --set samples=4)
check_status 1 "a fault, with a page and JUnit's XML" "$planted" "${rsm[@]:1}" --fault vk:denoise_columns:texel --html "$work/page" --junit "$work/junit.xml"
check "... of a pipeline" "$diptych" list --spec templates/rsm.yaml --json "$work/list.json"
check "... which show it, and no other" /usr/bin/python3 -B tests/app/compare_pages.py "$work/page" "$work/junit.xml" "$work/list.json"
check "agreement, with a page and JUnit's XML" "${rsm[@]}" --backend gl,vk,gl+glsl --html "$work/agree" --junit "$work/agree.xml"
tells_pairs() {
    [ "$(grep -c 'agree: every resource of every pass is within its contract' "$work/agree/index.html")" = 2 ] &&
        [ "$(grep -c 'failures="0"' "$work/agree.xml")" = 2 ] && [ "$(grep -c '<testcase' "$work/agree.xml")" = $((2 * $(grep -c "<testcase" "$work/junit.xml"))) ]
}
check "... of two pairs" tells_pairs
check "a page that cannot be written" refuses "Not a directory" "${rsm[@]}" --html "$work/junit.xml"
check "an XML file that cannot be written" refuses "$work/none" "${rsm[@]}" --junit "$work/none/it.xml"

# ---- Golden ------------------------------------------------------------------------------------------------------------

cp -r templates "$work/mine"
mine=("$diptych" compare --scene "$scene" --spec "$work/mine/rsm.yaml" --set rsm_size=16 --set samples=4)
kept="golden $work/golden: all resources are as kept"
check "a golden folder" "${mine[@]}" --size 15x9 --frames 2 --golden "$work/golden" --update
check "... keeps the pictures" "$diptych" render --scene "$scene" --spec "$work/mine/rsm.yaml" --set rsm_size=16 --set samples=4 \
    --size 15x9 --frames 2 --backend vk --show indirect -o "$work/indirect.png"
check "... that render shows" cmp "$work/indirect.png" "$work"/golden/*.denoise_columns.indirect.png
check "... agrees, in its size and frames" ends 0 "$kept" "${mine[@]}" --golden "$work/golden"
check "... with other drivers" ends 0 "$kept" "${mine[@]}" --golden "$work/golden" --backend osmesa,vk --json "$work/it.json"
check "... which is in the JSON" holds "it['golden'] == [] and it['width'] == 15 and it['frames'] == 2"
check "... refuses another size" refuses "holds a frame of 15x9" "${mine[@]}" --golden "$work/golden" --size 15x10
check "... and other values" refuses "was made with --set" "${mine[@]}" --golden "$work/golden" --set samples=5
check "... of a fault it keeps nothing" ends 1 "guilty: pass gather (shader rsm/gather.glsl): resource irradiance, in frame 0" "$planted" "${mine[@]:1}" \
    --size 15x9 --frames 2 --golden "$work/golden" --update --fault vk:gather:texel
check "... is as it was" ends 0 "$kept" "${mine[@]}" --golden "$work/golden"
sed -i 's/irradiance_rows/rows_of_it/g' "$work"/mine/*.yaml "$work"/mine/shared/*
check "... knows new names" ends 1 \
    "golden $work/golden: 2 resources are not as kept, first pass denoise_rows, resource rows_of_it: new; --update keeps the new ones" \
    "${mine[@]}" --golden "$work/golden" --json "$work/it.json"
check "... and old ones" holds "[(e['resource'], e['is']) for e in it['golden']] == [('rows_of_it', 'new'), ('irradiance_rows', 'gone')]"
cp -r templates/. "$work/mine"
sed -i 's/tile\.x));/tile.x) * 1.25);/' "$work/mine/shared/denoise_rows.glsl"
check "a change that both sides agree on differs from the golden folder" ends 1 \
    "golden $work/golden: 6 resources are not as kept, first pass denoise_rows, resource irradiance_rows: different; --update keeps the new ones" \
    "${mine[@]}" --golden "$work/golden" --junit "$work/junit.xml" --html "$work/page"
check "... in JUnit's XML" grep -A1 'name="rsm: golden" tests="6" failures="6"' "$work/junit.xml"
check "... and on the page" grep -A2 'Not as kept in' "$work/page/index.html"
check "... until it is updated" "${mine[@]}" --size 15x9 --frames 2 --golden "$work/golden" --update
check "... then it agrees" ends 0 "$kept" "${mine[@]}" --golden "$work/golden"
check "no golden folder" refuses "nothing is kept there; make it with --update" "${mine[@]}" --golden "$work/none"
echo '{"golden": 1, "set": [], "results": [{}]}' >"$work/golden/manifest.json"
check "a damaged golden folder" refuses "manifest.json: was not written by --golden" "${mine[@]}" --golden "$work/golden"
check "another folder" refuses "was not written by" "${mine[@]}" --size 8x8 --golden "$work/page" --update
check "--update alone" refuses "needs --golden" "${mine[@]}" --size 8x8 --update

# ---- Processes ---------------------------------------------------------------------------------------------------------

has_workers() { # text: three processes have it in their command
    [ "$(pgrep -fc -- "$1")" -ge 3 ]
}
all_gone() { # text: no process has it in its command
    ! pgrep -f -- "$1" >/dev/null
}
alone() { # signal status: a comparison that the signal ends leaves no worker
    local mark=$work/mark-$1 got
    "$diptych" compare --scene "$scene" --spec "$spec" --size 640x360 --frames 100000 --json "$mark" >"$work/table" 2>"$work/said" &
    local parent=$!
    wait_until has_workers "$mark"
    kill "-$1" "$parent"
    wait "$parent"
    got=$?
    cat "$work/said"
    wait_until all_gone "$mark"
    echo "exit status $got, left: $(pgrep -f -- "$mark" | xargs)"
    [ "$got" = "$2" ] && ! pgrep -f -- "$mark" && ! grep 'error:' "$work/said" && [ ! -s "$work/table" ] && [ ! -e "$mark" ]
}
check "SIGINT leaves no worker" alone INT 130
check "SIGTERM leaves no worker" alone TERM 143
check "SIGKILL leaves no worker" alone KILL 137
finish
