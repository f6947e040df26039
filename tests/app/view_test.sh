#!/usr/bin/env bash
# `diptych view` in real windows on an X server: sends keys, mouse and edits, and checks the content of the screen. TAP.
# shellcheck source=tests/lib/tap.sh
. "$(dirname "$0")/../lib/tap.sh"
for tool in Xvfb xdotool xwd; do
    if ! command -v $tool >/dev/null; then
        skip "windows" "$tool is not installed"
        finish
    fi
done
cp -r "$root/templates" "$work/templates"
cp "$root/scenes/cornell.obj" "$root/scenes/cornell.mtl" "$root/scenes/cornell.yaml" "$work"
spec=$work/templates/ssvp.yaml
tonemap=$work/templates/shared/tonemap.glsl
scene=$work/cornell.yaml
# Without a mean over frames a still scene has a still picture.
small=(--scene "$scene" --spec "$spec" --set rsm_size=64 --set map_size=32 --set accumulate=0 --set reuse_pattern=1 --set kept_maps=1
    --set first_vpls=64 --set second_vpls=96 --set clusters=3 --set map_triangles=300) # frames are made until a check holds
cd "$work" || exit 1 # where screenshots go

exec 3<>display.number
Xvfb -noreset -screen 0 2560x1440x24 -displayfd 3 2>/dev/null &
server=$!
trap 'kill $server; rm -rf "$work"' EXIT
wait_until [ -s display.number ]
DISPLAY=:$(cat display.number)
export DISPLAY
unset WAYLAND_DISPLAY

export XDG_CONFIG_HOME=$work/config # where the sizes of panes are kept
mkdir -p config/diptych
open_window() { # option...: does not wait for the first picture; `see` does
    echo 'hidden: 1' >config/diptych/view.yaml # all but the picture
    "$diptych" view "${small[@]}" --debug --json view.json "$@" >view.out 2>view.err &
    window=$!
}
see() { # file condition...
    local file=$1
    shift
    /usr/bin/python3 "$root/tests/app/view.py" "$file" $((tap_failed ? 60 : 600)) "$@" || { cat view.err && return 1; }
}
says() { # text: the window's process prints the text
    wait_until grep -qF -- "$1" view.err && return
    cat view.err
    return 1
}
has_ended() {
    ! kill -0 "$window" 2>/dev/null
}
ends() { # status: the window has ended with it, and the validation layers are silent
    local status
    wait_until has_ended || kill "$window"
    wait "$window"
    status=$?
    [ "$status" = "$1" ] || { cat view.err && echo "the window's exit status is $status" && return 1; }
    ! grep -E 'VUID|SYNC-HAZARD|hazard detected|debug message' view.err
}
holds_json() { # expression of d
    json_holds view.json "$1"
}
is_told() { # status text command...
    local status=$1 text=$2
    shift 2
    "$@" 2>told
    [ $? = "$status" ] || return
    grep -F -- "$text" told
}

# Both backends in one window, from the first picture to the last. References are taken at rest: frame 0 has no history yet.
open_window --backend both --size 240x180 --window 480x180
check "a window opens, and OpenGL's half is Vulkan's half" see panels.ppm shown size=480x180 halves still
xdotool key h
check "H shows what is around the picture" see panes.ppm not=panels.ppm shown
xdotool key h
check "... and hides it" see bare.ppm as=panels.ppm
xdotool key 1
check "1 is one bounce" see one.ppm not=panels.ppm shown halves
xdotool key 0
check "0 is none" see none.ppm not=one.ppm not=panels.ppm shown halves still
check "it is what render makes of either" "$diptych" render "${small[@]}" --backend vk --set bounces=0 --size 240x180 -o none.png
xdotool key c c
check "the difference is black" see black.ppm black size=480x180
xdotool key c
check "... and side by side again" see again.ppm as=none.ppm
xdotool key Tab
check "Tab shows another image" see other.ppm not=none.ppm shown halves
xdotool key Home
check "Home the picture again" see home.ppm as=none.ppm

# The camera.
xdotool mousemove 100 60 mousedown 1 mousemove 130 70 mouseup 1
check "the mouse turns the camera" see turned.ppm not=none.ppm shown halves
xdotool key w ctrl+s
check "Ctrl+S saves the camera" says "wrote diptych-000.motion.yaml"
check "... which W has moved" see moved.ppm not=turned.ppm shown halves
xdotool keydown ctrl keydown s keyup ctrl
sleep 0.5
xdotool keyup s
check "... and S has not, though it is let go of after Ctrl" see still.ppm as=moved.ppm shown halves
check "... and leaves the scene file alone" cmp "$root/scenes/cornell.yaml" "$scene"
check "... from which another program renders" "$diptych" render "${small[@]}" --motion diptych-000.motion.yaml --backend gl --set bounces=0 --size 240x180 -o saved.png
xdotool key p
check "P takes a screenshot" says "wrote diptych-000.png"

# Edits.
sed -i 's/display_store(p, vec4(/&0.5 * /' "$tonemap"
check "a saved body changes the picture" see dark.ppm not=moved.ppm shown halves
sed -i 's/vec3 codes/vec3 kodes/' "$tonemap"
check "a broken one is told with its caret, and the picture stays" see broken.ppm alarm top=dark.ppm
check "... on the terminal, too" says "'codes' : undeclared identifier"
check "... with its line" says "| "
cp "$root/templates/shared/tonemap.glsl" "$tonemap"
check "put right, it is as before" see right.ppm as=moved.ppm
part=$work/templates/shared/tonemap.yaml # which the spec includes
cp "$part" part.yaml
sed -i 's|shader: tonemap.glsl|shader: ../mine/tonemap.glsl|' "$part"
check "a body that is not there is told" says "cannot read the shader \`../mine/tonemap.glsl\`"
mkdir -p "$work/templates/mine"
cp "$work/templates/shared/"{estimate,srgb}.glsl "$work/templates/mine/" # which the body includes
sed 's/display_store(p, vec4(/&0.75 * /' "$tonemap" >"$work/templates/mine/tonemap.glsl"
check "... and taken when it comes, with the folder that it is in" see mine.ppm not=moved.ppm not=dark.ppm shown halves
cp part.yaml "$part"
check "... and put right" see right.ppm as=moved.ppm
sed -i '/name: average/,/groups:/s/groups: 1$/groups: "frame.width * (1920 - frame.width) + '$((RANDOM + 1))'"/' "$part" # valid at sizes that the generator tries, and new
check "a spec that the device cannot run is told, too, and the picture stays" see refused.ppm alarm top=moved.ppm
check "... with the reason" says "pass average"
cp part.yaml "$part"
check "... and goes on when it is put right" see right.ppm as=moved.ppm
check "... which made nothing" says "the pipeline is unchanged"

xdotool search --name diptych windowsize --sync 400 120
check "the window has another size" see resized.ppm size=400x120 shown halves
xdotool key Escape
check "Esc ends it, and the layers were silent" ends 0
check "it counted reloads, and measured every pass" holds_json \
    'd["reloads"] >= 2 and d["reload_ms"] > 0 and d["sides"][1]["frame_ms"] > 0 and d["sides"][0]["passes"][-1]["ms"] > 0'

# The screen shows the picture, row by row.
open_window --backend gl --size 240x180 --window 240x180 --set bounces=0 --motion diptych-000.motion.yaml
check "one backend shows what render writes with the saved camera" see gl.ppm as=saved.png
xdotool key Escape
check "... and ends in silence" ends 0
open_window --backend gl --size 80x60 --window 80x60 --frames 3 --screenshot all.png
check "with all bounces, too" ends 0
"$diptych" render "${small[@]}" --backend gl --size 80x60 --frames 3 -o rendered.png
check "... it is what render makes" cmp all.png rendered.png
# An input of half the frame's size keeps the frame as it is.
/usr/bin/python3 "$root/tests/app/outside.py" make .
mv small.png TINT.PNG
cat >enlarge.yaml <<'END'
pipeline: enlarge
images:
  photo: {input: true, format: rgba8, size: ["ceil_div(frame.width, 2)", "ceil_div(frame.height, 2)"]}
  tint: {file: TINT.PNG, format: rgba8}
  picture: {format: rgba8, size: frame}
passes:
  - {name: enlarge, dispatch: picture, reads: [photo, tint], writes: [picture], shader: enlarge.glsl}
output: {display: picture}
END
cat >enlarge.glsl <<'END'
void main()
{
    ivec2 p = invocation().xy;
    if (all(lessThan(p, picture_size())))
        picture_store(p, photo(p / 2) + tint(ivec2(0)));
}
END
"$diptych" view --spec enlarge.yaml --input photo=photo.png --backend gl --size 90x42 --window 90x42 >view.out 2>view.err &
window=$!
check "a window with an input" see enlarged.ppm shown size=90x42
touch TINT.PNG
check "a picture is watched, in any case of its ending" says "the pipeline is unchanged"
xdotool search --name diptych windowsize --sync 180 84
check "... takes another size" see large.ppm size=180x84 shown
xdotool key Escape
check "... and ends by Esc" ends 0

# An edit keeps the history of what has the same layout, and so does another size; another format is another layout.
cat >remember.yaml <<'END'
pipeline: remember
images:
  mark: {format: rgba8, size: [4, 4], history: true}
  picture: {format: rgba8, size: frame}
passes:
  - {name: remember, dispatch: mark, updates: [mark], shader: remember.glsl}
  - {name: show, dispatch: picture, reads: [mark], writes: [picture], shader: remember_show.glsl}
output: {display: picture}
END
cat >remember.glsl <<'END'
void main()
{
    ivec2 p = invocation().xy;
    if (all(lessThan(p, mark_size())))
        mark_store(p, vec4(1.0));
}
END
cat >remember_show.glsl <<'END'
void main()
{
    ivec2 p = invocation().xy;
    if (all(lessThan(p, picture_size())))
        picture_store(p, mark(ivec2(0)) * vec4(float(p.x & 1), 1.0, 0.0, 1.0));
}
END
echo 'hidden: 1' >config/diptych/view.yaml
"$diptych" view --spec remember.yaml --backend both --size 60x40 --window 120x40 >view.out 2>view.err &
window=$!
check "a window with a history" see marked.ppm shown size=120x40 halves
cp remember.glsl kept.glsl
sed -i 's/mark_store(p, vec4(1.0))/mark_store(p, mark(p))/' remember.glsl # writes no mark of its own
check "... which an edit keeps" says "reloaded in"
sed -i 's/1.0, 0.0, 1.0/0.5, 0.5, 1.0/' remember_show.glsl
check "... and another" see kept.ppm shown not=marked.ppm size=120x40 halves still
xdotool search --name diptych windowsize --sync 180 50
check "... and another size" see larger.ppm shown size=180x50 halves still
sed -i '/mark:/s/rgba8/rgba16f/' remember.yaml
check "... but not another format" see lost.ppm black
xdotool key Escape
check "... up to its end" ends 0

# From here on, any pipeline would do: one that opens at once.
cp kept.glsl remember.glsl
sed -i '/mark:/s/rgba16f/rgba8/' remember.yaml
small=(--spec remember.yaml)
"$diptych" render "${small[@]}" --backend vk --size 60x40 -o saved.png

# Another process tries an edited spec first. If that process crashes or hangs, the window stays open.
mkdir -p tools/build
cp "$build/diptych" "$build/diptych-gen" "$build/libdiptych_image.so" tools/build/
ln -s "$work/templates" tools/templates
mv tools/build/diptych-gen tools/build/real-gen
# shellcheck disable=SC2016 # these are the script's own
printf '#!/bin/sh\ncase $(cat "%s/try") in crash) kill -SEGV $$ ;; hang) ulimit -t 1; while :; do :; done ;; esac\nexec "%s" "$@"\n' \
    "$work" "$work/tools/build/real-gen" >tools/build/diptych-gen
chmod +x tools/build/diptych-gen
echo fine >try
diptych=$work/tools/build/diptych open_window --backend vk --size 60x40 --window 60x40
check "a window whose specs are tried elsewhere" see tried.ppm shown
for end in crash hang; do
    echo $end >try
    echo "// $RANDOM" >>remember_show.glsl
    check "a spec that makes a process $end" says "reading the spec was ended by signal"
    check "... leaves the window" kill -0 "$window"
    echo fine >try
    echo "// again" >>remember_show.glsl
    check "... and the next edit is taken" says "reloaded in"
    : >view.err
done
xdotool key Escape
check "... and the window ends as ever" ends 0

# A window manager minimises and restores the window, and a user drags its corner.
rests() { # the window's process is idle for a second
    local before after
    before=$(awk '{ print $14 + $15 }' "/proc/$window/stat") && sleep 1 &&
        after=$(awk '{ print $14 + $15 }' "/proc/$window/stat") && [ $((after - before)) -le 15 ]
}
is_gone() { # the window is not visible
    ! xdotool search --onlyvisible --name '^diptych'
}
if command -v twm >/dev/null; then
    printf '%s\n' NoTitle RandomPlacement IconifyByUnmapping NoGrabServer 'BorderWidth 0' \
        {Title,Resize,Menu,Icon,IconManager}'Font "fixed"' >twmrc # the font that any X server has
    LC_ALL=C twm -f twmrc 2>twm.err &
    manager=$!
    open_window --backend both --size 200x150 --window 200x150
    check "under a window manager" see managed.ppm shown
    id=$(xdotool search --name '^diptych')
    xdotool mousemove --window "$id" 50 75
    check "... at rest" see bare.ppm shown still
    xdotool windowminimize "$id"
    check "... is gone when it is minimised" wait_until is_gone
    check "... lets the processor be, then" wait_until rests
    xdotool windowmap --sync "$id"
    check "... comes back as it was" see back.ppm as=bare.ppm
    xdotool key Tab
    check "... and its frames go on" see next.ppm shown not=bare.ppm
    for k in $(seq 40); do
        xdotool windowsize "$id" $((1 + k * 97 % 300)) $((1 + k * 53 % 200))
    done
    xdotool windowminimize "$id"
    wait_until is_gone >/dev/null
    xdotool windowsize "$id" 260 90 windowmap --sync "$id"
    check "... stands being pulled about" see storm.ppm shown size=260x90
    xdotool windowminimize "$id"
    wait_until is_gone >/dev/null
    xdotool windowmap --sync "$id" mousemove --window "$id" 50 75 key Escape
    check "... and ends in silence" ends 0
    kill $manager # the clicks below are for windows where no manager places them
    wait $manager
else
    skip "minimised windows" "twm is not installed"
fi

# The window opens a lost device again, any number of times if losses are rare. After two quick losses it waits for the user.
losses=$build/tests/view_losses.so
for backend in gl vk both; do # with `both`, the second device is lost
    LOSE=31 LD_PRELOAD=$losses open_window --backend $backend --size 60x40 --window 60x40 --frames 40 --screenshot alive.png
    check "$backend outlives a device" ends 0
    check "... that was lost" says "told: the device is lost"
    check "... and opened anew" says "reopening the device"
    [ $backend = both ] || check "... and shows what it showed" cmp alive.png saved.png
done
LOSE_WINDOW=20 LD_PRELOAD=$losses open_window --backend vk --size 60x40 --window 60x40 --frames 40 --screenshot alive.png
check "a window whose context is lost is no end" ends 0
check "... it was" says "told: the window is lost"
check "... and opens anew" says "reopening the window"
check "... and shows what it showed" cmp alive.png saved.png
LOSE=40,60 LD_PRELOAD=$losses open_window --backend vk --size 60x40 --window 60x40
check "a device that is lost twice" says "Space, or a change of the pipeline, tries once more"
check "... leaves the panel" see lost.ppm shown still size=60x40
xdotool key space h
check "... and goes on by hand" see alive.ppm as=saved.png
xdotool key Escape
check "... up to its end" ends 0
LOSE=40,60 LD_PRELOAD=$losses open_window --backend gl --size 60x40 --window 60x40 --frames 100
check "with nobody there it is an error" ends 1
check "... that says so" says "the window ends"

# ---- The panes ------------------------------------------------------------------------------------------------------

panes=(--scene "$scene" --spec "$work/templates/rsm.yaml" --set rsm_size=64 --set samples=4 --size 160x120)
open_panes() { # option...
    rm -f config/diptych/view.yaml
    "$diptych" view "${panes[@]}" --json view.json "$@" >view.out 2>view.err &
    window=$!
}
click() { # x y: in the window at the left top corner of the screen; waits until the pointer has been seen
    xdotool mousemove "$1" "$2"
    sleep 0.4
    xdotool click 1
    sleep 1
    steps=$((steps + 1))
}
press() { # key...
    xdotool key "$@"
    sleep 0.7
    steps=$((steps + $#))
}

# Photographs, which were looked at: both backends and one, on a usual screen.
photograph() { # description name condition option...
    local name=$2 condition=$3
    open_panes "${@:4}"
    check "$1" see "$name.ppm" "$condition" "like=$root/tests/app/view/$name.png"
    xdotool key Escape
    wait "$window"
}
photograph "three sides look as they did" three verdict=green --window 1280x720 --backend gl,vk,vk@llvmpipe
photograph "a large screen" large verdict=green --window 2560x1440
check "a side photographs its window, alone and without a verdict" "$diptych" view "${panes[@]}" --frames 2 --backend vk --window 480x270 --present photo.png
check "... as it is" /usr/bin/python3 "$root/tests/app/view.py" --photo photo.png "$root/tests/app/view/small.png"
# A session of real work: find the guilty pass, read the texel, mend the body, save what was changed.
steps=0
body=$work/templates/shared/composite.glsl
sed -i 's/radiance_store(p, vec4(/#ifdef VULKAN\n#define SHARE 0.75\n#else\n#define SHARE 1.0\n#endif\n&SHARE * /' "$body"
check "the window says why" "$diptych" view "${panes[@]}" --backend both --window 640x360 --frames 3 --json view.json
check "... in the words of compare" holds_json '"a factor of " in d["why"]'
open_panes --backend both --window 1280x720
check "a body that is another in Vulkan is seen" see guilty.ppm verdict=red
press g
sleep 1
check "... shown by one key" see texel.ppm verdict=red "like=$root/tests/app/view/texel.png"
xdotool mousemove 472 272
steps=$((steps + 1))
sleep 1
cp "$root/templates/shared/composite.glsl" "$body"
check "... mended" says "reloaded in"
check "... and the verdict says so" see mended.ppm verdict=green
press space # no frames but for edits: clicks are seen at once
click 1076 206 # bounces: one less
press b        # ... and none of it again
press b
xdotool mousemove 640 20
click 1181 72 # save
check "what was changed is saved" says "wrote diptych-000.yaml"
check "... as overrides" grep -qx -- "- bounces=0" diptych-000.yaml
check "... in at most 12 steps" [ $steps -le 12 ]
# The numbers on the screen, as files.
xdotool key Home
click 422 91 # .npy
check "arrays are saved" says "wrote diptych-000-vk.npy"
# Sizes of panes are kept.
xdotool mousemove 302 400
sleep 0.5
xdotool mousedown 1
sleep 0.5
xdotool mousemove 362 400
sleep 0.5
xdotool mouseup 1
sleep 0.5
press F4 Escape
check "the session ends" ends 0
check "... with equal sides" holds_json 'd["verdict"].startswith("equal, ")'
check "sizes of panes are kept" grep -qx 'left: 3[56][0-9]' config/diptych/view.yaml
check "... and what is folded" grep -qx 'bottom_folded: 1' config/diptych/view.yaml
same_numbers() { # the array is what render dumps
    "$diptych" render "${panes[@]}" --backend vk --with diptych-000.yaml --dump dumped || return
    /usr/bin/python3 -c 'import glob, numpy
array = numpy.load("diptych-000-vk.npy")
dump = numpy.fromfile(glob.glob("dumped/*tonemap*display*")[0], "u1")
assert array.shape == (1, 120, 160, 4) and (array.ravel() == dump).all(), array.shape'
}
check "the array is what render dumps" same_numbers

# A planted fault, bisection, a table.
agrees() { # the window's verdict is that of compare
    "$planted" compare "${panes[@]}" --fault vk:rsm_map:sign --json compare.json >/dev/null
    /usr/bin/python3 -c 'import json
seen, told = json.load(open("fault.json"))["verdict"], json.load(open("compare.json"))["guilty"]
assert seen.startswith("differs: first pass %s, %s, " % (told["pass"], told["resource"])), (seen, told)'
}
diptych=$planted open_panes --backend both --window 1280x720 --fault vk:rsm_map:sign
check "a fault is red, and marked in its pass" see fault.ppm verdict=red "like=$root/tests/app/view/fault.png"
xdotool key space
click 1024 141 # bisect here
check "a case is written from the window" says "wrote diptych-000-case"
check "... and replays" "$diptych" replay diptych-000-case --backend gl
click 60 393 # taps
sleep 1
check "a buffer is a table" see table.ppm verdict=red "like=$root/tests/app/view/table.png"
click 1100 164 # live parameters: closed
click 1099 229 # samples: one more, for which the plan is made again
check "another number of samples makes the plan again" says "reloaded in"
: >view.err
xdotool key ctrl+z
check "... and undo makes it as it was" says "reloaded in"
xdotool key Escape
check "... and the window ends" ends 0
check "... with nothing changed" holds_json 'd["changes"] == ""'
cp view.json fault.json
check "its verdict names what compare names" agrees

# What a body does that is undefined.
/usr/bin/python3 -B "$root/tests/gen/sanitize.py" make "$work" 1
check "undefined behaviour is found" "$diptych" view --spec few.yaml --sanitize --backend vk --size 16x16 --window 640x480 --frames 2 --json view.json
check "... in its line" holds_json '": undefined: index 8 of " in d["undefined"]'

# Keys, clicks, drags and wheel at random, from a seed; with DIPTYCH_LONG for ten minutes, in the build with sanitizers if there is one.
survives() { # seconds
    local end=$((SECONDS + $1)) played=$seed
    while [ "$SECONDS" -lt "$end" ] && kill -0 "$window"; do
        SEED=$((played++)) /usr/bin/python3 "$root/tests/app/view.py" --random 40 | xdotool - || return
    done
    kill -0 "$window" && ! grep -E 'AddressSanitizer|runtime error' view.err
}
if [ -n "${DIPTYCH_LONG:-}" ] && [ -x "$root/build/asan/diptych" ]; then
    mkdir -p sanitized/build # it finds templates beside its folder
    ln -s "$work/templates" "$root/scenes" sanitized/
    cp "$build/diptych-gen" "$root"/build/asan/{diptych,libdiptych_image.so} sanitized/build/
    diptych=$work/sanitized/build/diptych
    export ASAN_OPTIONS=detect_leaks=0 # drivers keep memory
fi
open_panes --backend both --window 1280x720
check "a window for random input" see played.ppm verdict=green
seconds=5 seed=${SEED:-$RANDOM}
[ -z "${DIPTYCH_LONG:-}" ] || seconds=600
check "random input of seed $seed does no harm" survives $seconds
leaves() { # an Escape may close a field, and so do all that come in one frame
    xdotool mousemove 640 360 key Escape sleep 0.3
    has_ended
}
wait_until leaves
check "... up to the end" ends 0
echo 'font: 8' >config/diptych/view.yaml
check "the smallest letters do no harm" "$diptych" view "${panes[@]}" --backend vk --window 640x360 --frames 2

# Without a second driver, both backends become one, unless they were asked for.
alone() { # option...
    VK_DRIVER_FILES=/dev/null VK_ICD_FILENAMES=/dev/null "$diptych" view "${panes[@]}" --window 480x270 --frames 1 "$@"
}
check "OpenGL is shown alone where Vulkan is missing" alone
check_status 1 "... but not when both are asked for" alone --backend gl,vk

DISPLAY='' check "no display is an error" is_told 1 "no display" "$diptych" view "${small[@]}" --backend vk
DISPLAY=:4711 check "... for either" is_told 1 "no display" "$diptych" view "${small[@]}" --backend gl
check "four backends are too many" is_told 1 "at most 3 backends" "$diptych" view "${small[@]}" --backend gl,vk,gl,vk
check "zink has no window" is_told 1 "only gl and vk" "$diptych" view "${small[@]}" --backend zink
finish
