/* Filtering of scene_textures by texel fetches: the same bits on every device. Included by passes
 * that read scene_textures. */

/* Drivers decode sRGB to a few bits. */
vec4 texture_texel(ivec2 p, int layer, int level)
{
    vec4 texel = texelFetch(scene_textures, ivec3(p, layer), level);
#ifdef EXACT
    texel = filter_srgb(texel);
#endif
    return texel;
}

/* Bilinear between the texels around `uv`, with repeat. `uv`: 0..1. */
vec4 texture_bilinear(vec2 uv, int layer, int level)
{
    /* Mesa's CPU drivers take the level of one invocation for the textureSize of all. */
    ivec2 size = max(textureSize(scene_textures, 0).xy >> level, 1);
    vec2 place = uv * vec2(size) - 0.5;
    vec2 corner = floor(place);
    vec2 part = place - corner;
    ivec2 low = ivec2(corner);
    ivec2 high = low + 1;
    low = mix(low, low + size, lessThan(low, ivec2(0)));
    high = mix(high, high - size, greaterThanEqual(high, size));
    vec4 a = texture_texel(low, layer, level);
    vec4 b = texture_texel(ivec2(high.x, low.y), layer, level);
    vec4 c = texture_texel(ivec2(low.x, high.y), layer, level);
    vec4 d = texture_texel(high, layer, level);
    vec4 upper = a + (b - a) * part.x;
    vec4 lower = c + (d - c) * part.x;
    return upper + (lower - upper) * part.y;
}

/* Trilinear. `across`, `down`: change of uv from pixel to pixel. The mip is that of the longer one;
 * its binary logarithm runs straight between powers of two, which is at most 0.05 off. */
vec4 texture_trilinear(vec2 uv, vec2 across, vec2 down, int layer)
{
    vec2 size = vec2(textureSize(scene_textures, 0).xy);
    float square = max(dot(across * size, across * size), dot(down * size, down * size));
    float levels = float(textureQueryLevels(scene_textures) - 1);
    float level = 0.5 * (float(floatBitsToInt(square)) * (1.0 / 8388608.0) - 127.0);
    level = clamp(level, 0.0, levels);
    float fine = floor(level);
    vec2 wrapped = uv - floor(uv);
    vec4 near = texture_bilinear(wrapped, layer, int(fine));
    vec4 far = texture_bilinear(wrapped, layer, int(min(fine + 1.0, levels)));
    return near + (far - near) * (level - fine);
}
