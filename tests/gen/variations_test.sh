#!/usr/bin/env bash
# Random variations of shipped pipelines agree: 12, over 200 with DIPTYCH_LONG. SEED=N draws others. TAP.
. "$(dirname "$0")/../lib/tap.sh"
if ! /usr/bin/python3 -c 'import yaml' 2>"$work/output"; then
    skip "random variations" "needs python3-yaml"
    finish
fi
spot=$root/tests/specs/spot.yaml
sun=$root/tests/specs/directional.yaml
long=${DIPTYCH_LONG:-}

# Two scenes and both kinds of light; the long form has the narrowest and the widest cone that
# a scene may have, and the atrium.
scene_with() { # light: path of a scene with it
    local path
    path=$work/scene$((++scene_count)).yaml
    sed "s|^mesh: .*|mesh: $root/scenes/cornell.obj|; s|^light: .*|light: $1|" "$spot" >"$path"
    scenes+=(--scene "$path")
}
scene_count=0
scenes=(--scene "$root/scenes/cornell.yaml" --scene "$sun")
if [ -n "$long" ]; then
    scene_with '{kind: spot, position: [0.278, 0.5, 0.28], target: [0.278, 0, 0.28], cone: [0, 0.1], intensity: [90, 80, 70]}'
    scene_with '{kind: spot, position: [0.278, 0.27, 0.1], target: [0.278, 0.27, 1], cone: [85, 85], intensity: [1, 1, 1]}'
    scene_with '{kind: directional, direction: [0.1, -0.2, 1], irradiance: [5, 5, 5]}'
    scenes+=(--scene "$root/scenes/atrium.yaml")
fi

# shellcheck disable=SC2317 # called through check
vary() { # option...
    /usr/bin/python3 -B "$root/tests/gen/variations.py" --seed "${SEED:-4}" "$@" >"$work/said" 2>&1
    local status=$?
    cat "$work/said"
    return "$status"
}
if [ -n "$long" ]; then
    all=(--memory 64 ssvp=120 rsm=100)
else
    all=(ssvp=1 rsm=5 ssdo=1 deep=1 clustered=1 taa=1)
fi
check "variations agree, and every kind of setting is drawn" vary --kinds "${scenes[@]}" "$build" "$work" "${all[@]}"
grep '^# drawn' "$work/said"
check "variations of post agree" vary --input photo="$root/templates/post/table.png" "$build" "$work" post=2
grep '^# drawn' "$work/said"

# Rolls loops over hundreds of VPLs: unrolled, they take most of the time, and this check does not need them.
rolled=()
for range in shade.ranges.{first,second}_range {first,second}.map.test.ranges.elements; do
    rolled+=(--set "passes.$range.loop=roll" --set "passes.$range.storage=buffer")
done
# Unwritten memory differs between the backends, so compare notices a k-means that a driver cuts short.
check "k-means ends by itself with every parameter at its max" \
    "$diptych" compare --scene "$sun" --size 8x8 --set first_vpls=2048 --set clusters=64 --set kmeans_iterations=32 \
    --set position_weight=0 --set rsm_size=64 --set map_size=16 --set second_vpls=64 "${rolled[@]}"
finish
