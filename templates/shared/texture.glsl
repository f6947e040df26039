/* Filtering of scene_textures by texel fetches: the same bits on every device. Included by passes
 * that read scene_textures. */

/* Where `uv` lies in a level: its corner's two columns and two rows of texels, with repeat, and how
 * far it is from the first to the second. */
struct Corner {
    ivec2 low, high;
    vec2 part;
};

Corner texture_corner(vec2 uv, ivec2 finest, int level)
{
    ivec2 size = max(finest >> level, 1);
    vec2 place = uv * vec2(size) - 0.5;
    vec2 corner = floor(place);
    ivec2 p = clamp(ivec2(approximate_int(corner.x), approximate_int(corner.y)), ivec2(-1), size - 1);
    Corner c;
    c.low = mix(p, size - 1, lessThan(p, ivec2(0)));
    c.high = mix(p + 1, ivec2(0), equal(p + 1, size));
    c.part = place - corner;
    return c;
}

/* Color around `uv`, with repeat, linear between texels of `level` and, by the share `next`, of the
 * level after it. `uv`: 0..1. White if `layer` is negative: a loop without rounds, since Mesa's CPU
 * drivers run both sides of a branch. */
vec3 texture_linear(vec2 uv, int layer, int level, float next)
{
    /* Mesa's CPU drivers take the level of one invocation for the textureSize of all. */
    ivec2 finest = textureSize(scene_textures, 0).xy;
    Corner finer = texture_corner(uv, finest, level);
    Corner coarser = texture_corner(uv, finest, level + 1);
    int texels = layer < 0 ? 0 : next > 0.0 ? 8 : 4;
    vec3 color = vec3(layer < 0 ? 1.0 : 0.0);
    for (int i = 0; i < texels; i++) {
        ivec2 low = i < 4 ? finer.low : coarser.low;
        ivec2 high = i < 4 ? finer.high : coarser.high;
        vec2 part = i < 4 ? finer.part : coarser.part;
        bvec2 second = bvec2((i & 1) != 0, (i & 2) != 0);
        vec2 weight = mix(1.0 - part, part, second);
        float of_mip = i < 4 ? 1.0 - next : next;
        ivec2 p = mix(low, high, second);
        vec3 texel = texelFetch(scene_textures, ivec3(p, layer), level + i / 4).rgb;
        color += texel * (weight.x * weight.y * of_mip);
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
    level = approximate_clamp(level, levels);
    float fine = floor(level);
    return texture_linear(uv - floor(uv), layer, approximate_int(fine), level - fine);
}
