#!/usr/bin/env bash
# Frames of a motion: the pipelines get camera and light of each frame, and keep their history from frame to frame. Both backends
# give the same bits in every frame. The path tracer gets the same frames.
# shellcheck source=tests/lib/tap.sh
. "$(dirname "$0")/../lib/tap.sh"
scene=$root/scenes/cornell.yaml
motion=$work/motion.yaml
cat >"$motion" <<'MOTION'
keys:
  - {at: 0, camera: {eye: [0.278, 0.273, -0.8]}, light: {target: [0.556, 0.3, 0.35]}}
  - {at: 3, camera: {eye: [0.4, 0.3, -0.7]},     light: {target: [0.556, 0.2, 0.2]}}
MOTION
small=(--set first_vpls=64 --set second_vpls=64 --set clusters=3 --set rsm_size=64 --set map_size=32)
render=("$diptych" render --scene "$scene" --backend vk --size 48x27 "${small[@]}")
moving=("${render[@]}" --motion "$motion")
reference=("$diptych" reference --scene "$scene" --size 24x16 --spp 2)

complains() { # text command...
    local text=$1
    shift
    "$@" 2>"$work/err"
    [ $? = 2 ] && grep -qF -- "$text" "$work/err"
}
differ() {
    ! cmp -s "$1" "$2"
}

check "a picture of every frame" "${moving[@]}" -o "$work/frame_%02d.exr"
check "... as many as the motion has" [ "$(cd "$work" && echo frame_*)" = "frame_00.exr frame_01.exr frame_02.exr frame_03.exr" ]
check "the third picture is the last of three frames" "${moving[@]}" --frames 3 -o "$work/last.exr"
check "... to the bit" cmp "$work/frame_02.exr" "$work/last.exr"
check "the scene itself" "${render[@]}" -o "$work/still.exr"
check "... is the first frame, where the motion begins" cmp "$work/frame_00.exr" "$work/still.exr"
check "... and no other" differ "$work/frame_03.exr" "$work/still.exr"

# The same camera and light without the earlier frames: only the history differs.
printf 'keys: [{at: 0, camera: {eye: [0.4, 0.3, -0.7]}, light: {target: [0.556, 0.2, 0.2]}}]\n' >"$work/there.yaml"
check "the end of the motion without the way to it" "${render[@]}" --motion "$work/there.yaml" -o "$work/there.exr"
check "... is another picture: clusters go on from frame to frame" differ "$work/there.exr" "$work/frame_03.exr"

check "what the camera sees in the last frame" "${moving[@]}" --show gbuffer_position -o "$work/seen.exr"
check "... and from that place" "${render[@]}" --motion "$work/there.yaml" --show gbuffer_position -o "$work/seen_there.exr"
check "... is the same: it got there" cmp "$work/seen.exr" "$work/seen_there.exr"

check "both backends agree all along" "$diptych" compare --scene "$scene" --motion "$motion" --size 48x27 "${small[@]}"
check_status 1 "... but for a fault in one frame" "$planted" compare --scene "$scene" --motion "$motion" --size 48x27 "${small[@]}" \
    --fault vk:first.kmeans:bit@2
check "a dump of a motion" "${moving[@]}" --dump "$work/dump"
check "... is held against the same motion" "$diptych" compare --scene "$scene" --motion "$motion" "${small[@]}" --backend gl --against "$work/dump"
check "... and no other" complains "has other content, or its motion has" \
    "$diptych" compare --scene "$scene" --motion "$work/there.yaml" "${small[@]}" --backend gl --against "$work/dump"

# The previous frame's camera, with that frame's jitter, projects each point onto the texel that saw the point.
reproject=(--scene "$scene" --motion "$motion" --spec "$root/tests/specs/reproject.yaml" --size 48x27)
check "the camera before is the same on both backends" "$diptych" compare "${reproject[@]}" --backend gl,vk,gl+glsl
reprojects() { # frames expression options...: about `told`, the largest `away` by channel, and the number of texels seen
    local frames=$1 expression=$2
    shift 2
    rm -rf "$work/away"
    "$diptych" render "${reproject[@]}" --backend vk --frames "$frames" --dump "$work/away" "$@" || return
    /usr/bin/python3 - "$work/away" "$expression" <<'PYTHON'
import array, struct, sys
read = lambda name: open(f"{sys.argv[1]}/{name}", "rb").read()
away = array.array("f", read("01.reproject.away.raw"))
x, y, time, index, first = struct.unpack("2ff2I", read("02.keep.told.raw")[:20])
before, now, inverse = (max(away[i::4]) for i in range(3))
seen = sum(away[3::4])
near = before < 1e-3 and now < 1e-3 and inverse < 1e-4 and seen > 600
print(x, y, time, index, first, before, now, inverse, seen)
sys.exit(not eval(sys.argv[2]))
PYTHON
}
check "the first frame has itself before" reprojects 1 "near and first == 1 and index == 0 and time == 0 and (x, abs(y + 1 / 6) < 1e-6) == (0, True)"
check "... the second the first" reprojects 2 "near and first == 0 and index == 1 and (x, abs(y - 1 / 6) < 1e-6) == (-0.25, True)"
check "... the last the one before it, 60 of them a second" reprojects 4 "near and abs(time - 3 / 60) < 1e-6 and x == -0.375"
check "two positions repeat" reprojects 3 "near and x == 0 and index == 2" --set positions=2
check "no jitter" reprojects 4 "near and x == 0 and y == 0" --set positions=0
check_status 1 "a fault in the third frame" "$planted" compare "${reproject[@]}" --fault vk:reproject:bit@2 --bisect "$work/guilty"
check "... which has its camera before when it is played alone" "$diptych" replay "$work/guilty" --backend gl

check "the path tracer's first frame" "${reference[@]}" --motion "$motion" -o "$work/first.exr"
check "... its last" "${reference[@]}" --motion "$motion" --frame 3 -o "$work/third.exr"
check "... the scene, and the place where the motion ends" "${reference[@]}" -o "$work/scene.exr"
check "... alone" "${reference[@]}" --motion "$work/there.yaml" -o "$work/end.exr"
check "the first is the scene" cmp "$work/first.exr" "$work/scene.exr"
check "the last is that place" cmp "$work/third.exr" "$work/end.exr"

check "a frame of nothing that moves" complains "needs a --motion" "${reference[@]}" --frame 2 -o "$work/no.exr"
for name in 'a%s.exr' 'a%d_%d.exr' 'a%.exr' 'a%12d.exr'; do
    check "$name is no pattern" complains "one %d or %04d" "${render[@]}" -o "$work/$name"
done
check "a percent sign in a name" "${render[@]}" -o "$work/%3d%%.exr"
check "... is one" [ -e "$work/  0%.exr" ]
check "times of frames that are looked at" complains "--timings" "${moving[@]}" -o "$work/a%d.exr" --timings "$work/t.json"

flicker=("$diptych" flicker --scene "$scene" --motion "$motion")
shows() { # expression of the JSON's object r
    /usr/bin/python3 -c 'import json, sys; r = json.load(open(sys.argv[1])); sys.exit(not eval(sys.argv[2]))' "$work/flicker.json" "$1"
}
check "pictures held against themselves" "${flicker[@]}" --test "$work/frame_%02d.exr" --reference "$work/frame_%02d.exr" \
    --json "$work/flicker.json"
check "... have no flicker, but change" shows 'r["flicker"] == 0 and r["excess"] == 0 and r["change"] > 0'
check "... in three steps, of which the mean is over pixels" shows \
    'len(r["per_frame"]) == 3 and r["compared"] == sum(f["compared"] for f in r["per_frame"])'
check "... where the same surface is seen" shows 'r["surfaces"] * 0.5 < r["compared"] < r["surfaces"]'
for frame in 0 1 2; do cp "$work/still.exr" "$work/still_$frame.exr"; done
check "one picture, three times" "$diptych" flicker --scene "$scene" --frames 3 --test "$work/still_%d.exr" --json "$work/flicker.json"
check "... does not change" shows 'r["change"] == 0 and r["compared"] == r["surfaces"] > 0 and "flicker" not in r'
fails() { # text command...
    local text=$1
    shift
    "$@" 2>"$work/err"
    [ $? = 1 ] && grep -qF -- "$text" "$work/err"
}
check "one frame alone" fails "one frame has no change" "${flicker[@]}" --frames 1 --test "$work/frame_%02d.exr"
check "a frame that is not there" fails "frame_04.exr" "${flicker[@]}" --frames 5 --test "$work/frame_%02d.exr"
cp "$work/first.exr" "$work/small_00.exr"
check "another size" fails "frame 0 of $work/small_%02d.exr has 24x16 pixels, not 48x27" "${flicker[@]}" \
    --test "$work/frame_%02d.exr" --reference "$work/small_%02d.exr"
check "a picture in place of a pattern" complains "names one picture" "${flicker[@]}" --test "$work/still.exr"
finish
