#!/usr/bin/env bash
# The mean of indirect light over frames: nearer to the path tracer than a frame alone, also where the camera moves and shows what
# was hidden; it follows a light that moves. Both backends give the same bits in every frame.
# shellcheck source=tests/lib/tap.sh
. "$(dirname "$0")/../lib/tap.sh"
scene=$root/scenes/cornell.yaml
size=64x36
small=(--set rsm_size=256 --set map_size=64)
# The camera goes round the boxes; what they hid comes out beside them.
cat >"$work/round.yaml" <<'MOTION'
keys:
  - {at: 0,  camera: {eye: [0.1, 0.35, -0.6],  target: [0.3, 0.15, 0.2]}}
  - {at: 11, camera: {eye: [0.45, 0.35, -0.6], target: [0.25, 0.15, 0.2]}}
MOTION
# The light stands still, then it turns to the other side of the wall at once.
cat >"$work/turn.yaml" <<'MOTION'
keys:
  - {at: 0,  light: {target: [0.556, 0.3, 0.35]}}
  - {at: 11, light: {target: [0.556, 0.3, 0.35]}}
  - {at: 12, light: {target: [0.556, 0.1, 0.1]}}
MOTION

ours() { # picture arguments...
    local picture=$work/$1
    shift
    "$diptych" render --scene "$scene" --backend vk --size "$size" "${small[@]}" --show indirect "$@" -o "$picture"
}

truth() { # picture arguments...
    local picture=$work/$1
    shift
    "$diptych" reference --scene "$scene" --size "$size" --from-bounce 1 --quantity irradiance --spp 256 "$@" -o "$picture"
}

error() { # reference picture: the relative MSE
    "$diptych" metrics --reference "$work/$1" --test "$work/$2" --exposure 1 --flip ldr --json "$work/error.json" >/dev/null &&
        /usr/bin/python3 -c 'import json, sys; print(json.load(open(sys.argv[1]))["hdr"]["relative_mse"])' "$work/error.json"
}

below() { # reference picture factor other: the error of the picture is below `factor` times the other's
    local mine others
    mine=$(error "$1" "$2") && others=$(error "$1" "$4") && echo "relative MSE: $2 $mine, $4 $others" &&
        awk "BEGIN { exit !($mine < $3 * $others) }"
}

prepare() {
    truth still.exr && ours still.%02d.exr --frames 16 && ours alone.%02d.exr --frames 16 --set accumulate=0
}
check "a still scene, traced and rendered" prepare
check "the first frame has no mean" cmp "$work/still.00.exr" "$work/alone.00.exr"
check "after 16 frames the mean is nearer than a frame" below still.exr still.15.exr 0.75 still.00.exr
check "... and no frame alone is" below still.exr still.15.exr 0.75 alone.15.exr
check "the second frame is between" below still.exr still.01.exr 0.95 alone.01.exr

moves() { # motion frame
    local moving=(--motion "$work/$1.yaml")
    truth "$1.exr" "${moving[@]}" --frame "$2" && ours "$1.%02d.exr" "${moving[@]}" && ours "$1_alone.%02d.exr" "${moving[@]}" --set accumulate=0
}
check "a camera that moves" moves round 11
check "what comes out from behind a box does not smear" below round.exr round.11.exr 0.8 round_alone.11.exr
check "a light that turns" moves turn 12
check "the mean follows the light" below turn.exr turn.12.exr 1.2 turn_alone.12.exr

motions=(round turn) # one in short runs
[ -n "${DIPTYCH_LONG:-}" ] || motions=("${motions[${SEED:-RANDOM} % 2]}")
for motion in "${motions[@]}"; do
    check "$motion: both backends agree in every frame" "$diptych" compare --scene "$scene" --motion "$work/$motion.yaml" --size 48x27 \
        --set first_vpls=64 --set second_vpls=64 --set clusters=3 --set rsm_size=64 --set map_size=32
done
check_status 1 "a fault in the mean of one frame is still seen in the next" "$planted" compare --scene "$scene" --size 48x27 --frames 3 \
    --set first_vpls=64 --set second_vpls=64 --set clusters=3 --set rsm_size=64 --set map_size=32 --fault vk:accumulate:bit@1
finish
