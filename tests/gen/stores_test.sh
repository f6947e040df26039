#!/usr/bin/env bash
# Stores into formats of few bits, from dispatches and as colour targets, round to nearest, ties to even, on every driver. TAP.
. "$(dirname "$0")/../lib/tap.sh"
. "$root/tests/lib/drivers.sh"
spec=$root/tests/specs/stores.yaml
/usr/bin/python3 "$root/tests/gen/stores.py" make "$work" || exit 1
input=(--input values="$work/values.npy" --input fractions="$work/fractions.npy" --size 320x300)

right() { # backend
    rm -rf "$work/dump"
    "$diptych" render --spec "$spec" "${input[@]}" --backend "$1" --dump "$work/dump" -o "$work/picture.png" &&
        /usr/bin/python3 "$root/tests/gen/stores.py" check "$work/dump" "$work"
}

for backend in gl gl+glsl vk@llvmpipe "${strangers[@]}"; do
    check "$backend rounds every store to the nearest code" right "$backend"
done
[ ${#strangers[@]} -gt 0 ] || skip "another driver rounds every store to the nearest code" "$no_strangers"
# The same of shaders that declare everything themselves. `codes` has every code; `halves` lie between two codes.
cat >"$work/own.yaml" <<'END'
pipeline: own
images:
  codes:  {format: rgba8, size: [256, 1]}
  shorts: {format: r16_snorm, size: [256, 1]}
  read:   {format: rg32f, size: [256, 1]}
  halves: {format: rg8, size: [256, 1]}
samplers:
  near: {kind: filter}
passes:
  - {name: fill, dispatch: codes, local: [8, 1, 1], writes: [codes, shorts], shader: fill.comp}
  - {name: look, dispatch: read, local: [8, 1, 1], writes: [read],
     reads: [{name: codes, sampler: near}, {name: shorts, sampler: near}], shader: look.comp}
  - {name: draw, draw: fullscreen, reads: [codes], writes: [halves], shader: draw.frag}
output: {display: codes}
END
cat >"$work/fill.comp" <<'END'
#version 450
layout(local_size_x = 8) in;
layout(binding = 0, rgba8) writeonly uniform image2D codes;
layout(binding = 1, r16_snorm) writeonly uniform image2D shorts;
void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    imageStore(codes, p, vec4(float(p.x) / 255.0));
    imageStore(shorts, p, vec4(float(p.x * 257 - 32768) / 32767.0));
}
END
cat >"$work/look.comp" <<'END'
#version 450
layout(local_size_x = 8) in;
layout(binding = 0) uniform sampler2D codes;
layout(binding = 1) uniform sampler2D shorts;
layout(binding = 2, rg32f) writeonly uniform image2D read;
float texel(sampler2D image, ivec2 p) /* one caller */
{
    return texelFetch(image, p, 0).r;
}
void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    imageStore(read, p, vec4(texel(codes, p), texelFetch(shorts, p, 0).r, 0.0, 0.0));
}
END
cat >"$work/draw.frag" <<'END'
#version 450
layout(binding = 0) uniform sampler2D codes;
layout(location = 0) out vec2 halves;
void main()
{
    if (gl_FragCoord.x > 200.0) {
        halves = vec2(0.25);
        return;
    }
    halves = vec2(texelFetch(codes, ivec2(gl_FragCoord.xy), 0).r + 0.5 / 255.0, -1.0);
}
END
own_right() { # backend
    rm -rf "$work/dump"
    "$diptych" render --spec "$work/own.yaml" --size 8x8 --backend "$1" --dump "$work/dump" -o "$work/picture.png" &&
        /usr/bin/python3 "$root/tests/gen/stores.py" own "$work/dump"
}
for backend in gl gl+glsl vk@llvmpipe "${strangers[@]}"; do
    check "$backend: shaders that declare all themselves read and store the same" own_right "$backend"
done
refused() {
    sed -i 's/texelFetch(shorts, p, 0).r/texel(shorts, p)/' "$work/look.comp" &&
        ! "$build/diptych-gen" "$work/own.yaml" --check 2>"$work/why" && cat "$work/why" &&
        grep -q 'images of different formats by one parameter' "$work/why" &&
        "$build/diptych-gen" "$work/own.yaml" --check --set exactness=fast
}
check "a function that reads two formats by one parameter is refused, but not in fast mode" refused
refused_parts() {
    sed -i 's/out vec2 halves;/out vec2 halves[1];/; s/halves = /halves[0] = /' "$work/draw.frag" &&
        sed -i 's/texel(shorts, p)/0.0/' "$work/look.comp" && ! "$build/diptych-gen" "$work/own.yaml" --check 2>"$work/why" &&
        cat "$work/why" && grep -q 'an array of colour targets' "$work/why"
}
check "... and so is an array of colour targets" refused_parts
finish
