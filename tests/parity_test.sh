#!/usr/bin/env bash
# Both backends must agree in every bit of every resource of every pass: over pipelines, scenes (one lit directionally, one by
# a spot light), frame sizes that the tile divides and that it does not, and cluster counts. Validation must stay silent.
. "$(dirname "$0")/tap.sh"
cornell=$root/scenes/cornell.yaml
atrium=$root/scenes/atrium.yaml
ssvp=$root/templates/ssvp.yaml
rsm=$root/templates/rsm.yaml

for scene in "$cornell" "$atrium"; do
    name=$(basename "$scene" .yaml)
    for size in 64x32 37x23 1x1; do
        counts=(4)
        [ $size != 37x23 ] || counts+=(32)
        for clusters in "${counts[@]}"; do
            check "ssvp agrees on $name at $size with $clusters clusters" \
                "$diptych" compare --scene "$scene" --spec "$ssvp" --size $size --set "clusters=$clusters" --debug
        done
        check "rsm agrees on $name at $size" \
            "$diptych" compare --scene "$scene" --spec "$rsm" --size $size --debug
    done
done
for bounces in 0 1; do
    check "ssvp agrees with bounces=$bounces, whose passes are skipped" \
        "$diptych" compare --scene "$cornell" --spec "$ssvp" --size 37x23 --set bounces=$bounces --debug
done
check "ssvp agrees over three frames, whose clusters are seeded from the last" \
    "$diptych" compare --scene "$cornell" --spec "$ssvp" --size 37x23 --frames 3 --debug
check "ssvp agrees with a tile of 3x2 and counts that it does not divide" \
    "$diptych" compare --scene "$cornell" --spec "$ssvp" --size 37x23 --set 'tile=[3,2]' --set first_vpls=100 --set second_vpls=128 --set clusters=3 --debug
check "ssvp agrees with Equation 2 as printed" \
    "$diptych" compare --scene "$cornell" --spec "$ssvp" --size 37x23 --set metrics.vpl_distance.normal_term=dot --debug
check "ssvp agrees without second-bounce visibility, whose passes stay for what they clear" \
    "$diptych" compare --scene "$cornell" --spec "$ssvp" --size 37x23 --set second_clusters=0 --debug
check "ssvp agrees split and gathered" \
    "$diptych" compare --scene "$cornell" --spec "$ssvp" --size 37x23 --set split=1 --debug

check "instant radiosity agrees" \
    "$diptych" compare --scene "$cornell" --spec "$root/templates/instant_radiosity.yaml" --size 37x23 --set first_vpls=24 --debug

# Where a range's elements live and how its loop is written changes the time, never a bit. 128 second-bounce VPLs fit into
# a uniform block.
ranges=passes.shade.ranges
# shellcheck disable=SC2317 # called through check
shade() { # file sets...
    local file=$1
    shift
    "$diptych" compare --scene "$cornell" --spec "$ssvp" --size 37x23 --set second_vpls=128 --debug "$@" &&
        "$diptych" render --scene "$cornell" --spec "$ssvp" --size 37x23 --set second_vpls=128 --backend vk \
            --dump "$work/dump" "$@" &&
        cat "$work"/dump/*.shade.irradiance.raw >"$work/$file"
}
check "shading, as planned" shade planned
check "shading, planned for a GPU" shade gpu --set target=gpu
check "shading, rolled loops" shade rolled --set $ranges.first_range.loop=roll --set $ranges.second_range.loop=roll
check "shading, from storage buffers" shade buffer \
    --set $ranges.first_range.storage=buffer --set $ranges.second_range.storage=buffer
check "shading, from a uniform block" shade uniform --set $ranges.second_range.storage=uniform
check "shading, loops that read their counts" shade counted \
    --set $ranges.first_range.storage=buffer --set $ranges.first_range.loop=roll \
    --set $ranges.second_range.storage=uniform --set $ranges.second_range.loop=roll
for shape in gpu rolled buffer uniform counted; do
    check "shading, $shape: the same bits" cmp "$work/planned" "$work/$shape"
done
finish
