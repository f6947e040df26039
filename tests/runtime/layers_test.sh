#!/usr/bin/env bash
# On a Vulkan device without shaderOutputLayer the runtime draws each layer alone; the bits stay the same. tests/lib/no_layer.c hides
# the feature; SwiftShader lacks it. The vertex shader must drop triangles of other layers, or each layer would have all of them.
. "$(dirname "$0")/../lib/tap.sh"
scene=$root/scenes/cornell.yaml
specs=$root/tests/specs

hidden=(env "LD_PRELOAD=$build/tests/no_layer.so" "$diptych")
for spec in "$specs"/{shapes,cull,features,body}.yaml "$root"/templates/{ssvp,instant_radiosity}.yaml; do
    check "$(basename "$spec" .yaml), a layer at a time" "${hidden[@]}" compare --scene "$scene" --spec "$spec" --size 64x48
done
check "validation is silent" "${hidden[@]}" compare --scene "$scene" --spec "$specs/cull.yaml" --size 64x48 --debug

. "$root/tests/lib/drivers.sh"
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
