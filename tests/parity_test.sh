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
        for clusters in 4 32; do
            check "ssvp agrees on $name at $size with $clusters clusters" \
                "$diptych" compare --scene "$scene" --spec "$ssvp" --size $size --set clusters=$clusters --debug
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
finish
