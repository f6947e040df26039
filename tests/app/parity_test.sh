#!/usr/bin/env bash
# Both backends must agree in every bit of every resource of every pass: over pipelines, frames, scenes (one lit directionally, one
# by a spot light), frame sizes that the tile divides and that it does not, and cluster counts. Validation must stay silent. (Tiles
# that divide no count are in repeat_test.sh.) Mesa's shaders depend on whether the sides of images are powers of two: few sizes
# mean few shaders. SEED draws the pipeline in one pixel and three of six other forms; DIPTYCH_LONG has all, and more samples.
. "$(dirname "$0")/../lib/tap.sh"
cornell=$root/scenes/cornell.yaml
ssvp=$root/templates/ssvp.yaml

agrees() { # what pipeline scene options...
    local what=$1 pipeline=$2 scene=$3
    shift 3
    check "$pipeline agrees $what" \
        "$diptych" compare --scene "$root/scenes/$scene.yaml" --spec "$root/templates/$pipeline.yaml" --debug "$@"
}
fewer=(--set clusters=4 --set first_vpls=64 --set map_size=64) # shaders with more take longer to compile than to run
small=(--set rsm_size=128) # where the RSM is not the subject
samples=() # of ssdo and deep, whose loops Mesa writes out
[ -n "${DIPTYCH_LONG:-}" ] || samples=(--set samples=8)
room=(--set map_triangles=3000) # compare reads back what the lists of triangles have room for; the Cornell Box has 30
frames=(--size 37x23 --frames 3) # clusters are seeded from the last frame
agrees "on cornell" rsm cornell "${frames[@]}"
for pipeline in ssdo deep; do
    agrees "on cornell" $pipeline cornell "${frames[@]}" "${small[@]}" "${samples[@]}"
done
agrees "on atrium" ssvp atrium --size 37x23 "${small[@]}" "${fewer[@]}"
fewer+=("${small[@]}" "${room[@]}")
agrees "on cornell" clustered cornell "${frames[@]}" "${fewer[@]}"
agrees "on cornell" ssvp cornell "${frames[@]}" "${small[@]}" "${room[@]}"
few=("${fewer[@]}" --set second_vpls=64)
seed=${SEED:-$RANDOM}
pipelines=(rsm ssdo deep clustered)
[ -n "${DIPTYCH_LONG:-}" ] || pipelines=("${pipelines[seed % 4]}")
for pipeline in "${pipelines[@]}"; do
    case $pipeline in
    rsm) options=("${small[@]}") ;;
    clustered) options=("${fewer[@]}") ;;
    *) options=("${small[@]}" "${samples[@]}") ;;
    esac
    agrees "in one pixel (seed $seed)" "$pipeline" cornell --size 1x1 "${options[@]}"
done
drawn() { # three of the six checks that begin so, by the seed; all in long runs
    number=$((number + 1))
    [ -n "${DIPTYCH_LONG:-}" ] || [ $(((number + seed / 4) % 2)) = 0 ]
}
number=0
drawn && agrees "in one pixel, first bounce alone, whose other passes are skipped" ssvp cornell --size 1x1 "${few[@]}" --set bounces=1
agrees "in a frame that the tile divides, direct light alone" rsm cornell --size 68x36 "${small[@]}" --set bounces=0
drawn && agrees "with 32 clusters" ssvp cornell --size 37x23 "${few[@]}" --set clusters=32
drawn && agrees "as printed: the paper's way, Equation 2; passes of second-bounce visibility stay for what they clear" ssvp cornell \
    --size 37x23 "${few[@]}" --with "$root/templates/ssvp/paper.yaml" --set metrics.vpl_distance.normal_term=dot

drawn && check "instant radiosity agrees" \
    "$diptych" compare --scene "$cornell" --spec "$root/templates/instant_radiosity.yaml" --size 37x23 "${small[@]}" --set first_vpls=24 --debug

check "taa agrees while the camera moves" "$diptych" compare --scene "$cornell" --motion "$root/scenes/cornell_walk.yaml" \
    --spec "$root/templates/taa.yaml" --size 37x23 "${small[@]}" --frames 4 --debug
for picture in templates/pictures/ssdo.png templates/post/table.png; do
    check "post agrees on $picture" \
        "$diptych" compare --spec "$root/templates/post.yaml" --input "photo=$root/$picture" --debug
done

# Other storage and loops of ranges. metamorphic_test.sh shows that these leave the same bits as the defaults. 128 second-bounce
# VPLs fit into a uniform block.
ranges=passes.shade.ranges
shading=("$diptych" compare --scene "$cornell" --spec "$ssvp" --size 37x23 "${fewer[@]}" --set second_vpls=128 --debug)
drawn && check "ssvp agrees planned for a GPU" "${shading[@]}" --set target=gpu
drawn && check "ssvp agrees with loops that read their counts, over a storage buffer and a uniform block" "${shading[@]}" \
    --set $ranges.first_range.storage=buffer --set $ranges.first_range.loop=roll \
    --set $ranges.second_range.storage=uniform --set $ranges.second_range.loop=roll
finish
