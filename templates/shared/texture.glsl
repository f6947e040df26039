/* Filtering of scene_textures by texel fetches: the same bits on every device. Included by passes
 * that read scene_textures. */

/* Color around `uv`, with repeat, linear between texels of `level` and, by the share `next`, of the
 * level after it. `uv`: 0..1. White if `layer` is negative: a loop without rounds, since Mesa's CPU
 * drivers run both sides of a branch. */
vec3 texture_linear(vec2 uv, int layer, int level, float next)
{
    /* Mesa's CPU drivers take the level of one invocation for the textureSize of all. */
    ivec2 finest = textureSize(scene_textures, 0).xy;
    int texels = layer < 0 ? 0 : next > 0.0 ? 8 : 4;
    vec3 color = vec3(layer < 0 ? 1.0 : 0.0);
    for (int i = 0; i < texels; i++) {
        int mip = level + i / 4;
        ivec2 size = max(finest >> mip, 1);
        vec2 place = uv * vec2(size) - 0.5;
        vec2 corner = floor(place);
        vec2 part = place - corner;
        bvec2 high = bvec2((i & 1) != 0, (i & 2) != 0);
        ivec2 p = ivec2(corner) + ivec2(high);
        p = mix(p, p + size, lessThan(p, ivec2(0)));
        p = mix(p, p - size, greaterThanEqual(p, size));
        vec2 weight = mix(1.0 - part, part, high);
        float of_mip = i < 4 ? 1.0 - next : next;
        color += texelFetch(scene_textures, ivec3(p, layer), mip).rgb * (weight.x * weight.y * of_mip);
    }
    return color;
}

/* Trilinear. `across`, `down`: change of uv from pixel to pixel. The mip is that of the longer one;
 * its binary logarithm runs straight between powers of two, which is at most 0.05 off. */
vec3 texture_trilinear(vec2 uv, vec2 across, vec2 down, int layer)
{
    vec2 size = vec2(textureSize(scene_textures, 0).xy);
    float square = max(dot(across * size, across * size), dot(down * size, down * size));
    float levels = float(textureQueryLevels(scene_textures) - 1);
    float level = 0.5 * (float(floatBitsToInt(square)) * (1.0 / 8388608.0) - 127.0);
    level = clamp(level, 0.0, levels);
    float fine = floor(level);
    return texture_linear(uv - floor(uv), layer, int(fine), level - fine);
}
