#!/usr/bin/env bash
# Layered draws on a Vulkan device without shaderOutputLayer, which draws each layer alone: the same bits. tests/no_layer.c hides
# the feature; SwiftShader has none. The vertex shader still drops what belongs to other layers, or everything would be in each.
. "$(dirname "$0")/tap.sh"
scene=$root/scenes/cornell.yaml
specs=$root/tests/specs

hidden=(env "LD_PRELOAD=$build/tests/no_layer.so" "$diptych")
for spec in "$specs"/{shapes,cull,features,body}.yaml "$root"/templates/{ssvp,instant_radiosity}.yaml; do
    check "$(basename "$spec" .yaml), a layer at a time" "${hidden[@]}" compare --scene "$scene" --spec "$spec" --size 64x48
done
check "validation is silent" "${hidden[@]}" compare --scene "$scene" --spec "$specs/cull.yaml" --size 64x48 --debug

. "$root/tests/drivers.sh"
# shellcheck disable=SC2317 # called through check
draws_alike() {
    "$diptych" compare --spec "$specs/shapes.yaml" --size 64x48 --backend "vk@llvmpipe,${strangers[0]}" >"$work/table"
    [ "$(grep -cE '^draw_(sky|probes) .* 0  equal' "$work/table")" = 3 ] || ! cat "$work/table"
}
if [ ${#strangers[@]} -gt 0 ]; then
    check "all layers are alike on ${strangers[*]}" draws_alike
else
    skip "all layers are alike on another driver" "$no_strangers"
fi
finish
