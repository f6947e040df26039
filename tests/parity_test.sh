#!/usr/bin/env bash
# Both backends must agree in every bit of every resource of every pass: over pipelines, scenes (one lit directionally, one by
# a spot light), frame sizes that the tile divides and that it does not, and cluster counts. Validation must stay silent. (Tiles
# that divide no count are in repeat_test.sh.)
. "$(dirname "$0")/tap.sh"
cornell=$root/scenes/cornell.yaml
atrium=$root/scenes/atrium.yaml
ssvp=$root/templates/ssvp.yaml

for frame in "$cornell 64x32" "$cornell 37x23" "$cornell 1x1" "$atrium 37x23"; do
    read -r scene size <<<"$frame"
    name=$(basename "$scene" .yaml)
    check "ssvp agrees on $name at $size" "$diptych" compare --scene "$scene" --spec "$ssvp" --size "$size" --set clusters=4 --debug
    [ "$size" != 64x32 ] || continue # tiles that divide the frame are the easy case
    for pipeline in rsm ssdo deep clustered; do
        check "$pipeline agrees on $name at $size" \
            "$diptych" compare --scene "$scene" --spec "$root/templates/$pipeline.yaml" --size "$size" --debug
    done
done
check "ssvp agrees with 32 clusters" \
    "$diptych" compare --scene "$cornell" --spec "$ssvp" --size 37x23 --set clusters=32 --debug
for bounces in 0 1; do
    check "ssvp agrees with bounces=$bounces, whose passes are skipped" \
        "$diptych" compare --scene "$cornell" --spec "$ssvp" --size 37x23 --set bounces=$bounces --debug
done
check "ssvp agrees over three frames, whose clusters are seeded from the last" \
    "$diptych" compare --scene "$cornell" --spec "$ssvp" --size 37x23 --frames 3 --debug
check "ssvp agrees with Equation 2 as printed" \
    "$diptych" compare --scene "$cornell" --spec "$ssvp" --size 37x23 --set metrics.vpl_distance.normal_term=dot --debug
check "ssvp agrees without second-bounce visibility, whose passes stay for what they clear" \
    "$diptych" compare --scene "$cornell" --spec "$ssvp" --size 37x23 --set second_clusters=0 --debug
check "ssvp agrees split and gathered" \
    "$diptych" compare --scene "$cornell" --spec "$ssvp" --size 37x23 --set split=1 --debug

check "instant radiosity agrees" \
    "$diptych" compare --scene "$cornell" --spec "$root/templates/instant_radiosity.yaml" --size 37x23 --set first_vpls=24 --debug

check "taa agrees while the camera moves" "$diptych" compare --scene "$cornell" --motion "$root/scenes/cornell_walk.yaml" \
    --spec "$root/templates/taa.yaml" --size 37x23 --frames 4 --debug
for picture in templates/pictures/ssdo.png templates/post/table.png; do
    check "post agrees on $picture" \
        "$diptych" compare --spec "$root/templates/post.yaml" --input "photo=$root/$picture" --debug
done

# Other places for the elements of ranges, and other loops: that they leave the same bits is shown by metamorphic_test.sh. 128
# second-bounce VPLs fit into a uniform block.
ranges=passes.shade.ranges
shading=("$diptych" compare --scene "$cornell" --spec "$ssvp" --size 37x23 --set second_vpls=128 --debug)
check "ssvp agrees planned for a GPU" "${shading[@]}" --set target=gpu
check "ssvp agrees with loops that read their counts, over a storage buffer and a uniform block" "${shading[@]}" \
    --set $ranges.first_range.storage=buffer --set $ranges.first_range.loop=roll \
    --set $ranges.second_range.storage=uniform --set $ranges.second_range.loop=roll
finish
