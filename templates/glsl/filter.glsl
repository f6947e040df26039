/* Filtering of images in floats, by texel fetches: the same bits on every device, whose own filters
 * round weights to a few bits. What NAME_sample and NAME_sample_lod of exact pipelines call.
 * mode: 0 clamp, 1 repeat, 2 mirror, 3 border; and 4 for sRGB. */

/* Drivers decode sRGB to a few bits. So the code of 8 bits is found again from what they give, by a
 * fit of the encoding that is 0.12 codes off, and decoded here (IEC 61966-2-1). */
float filter_decode(float light)
{
    precise float u = exact_sqrt(light);
    precise float fit = ((((0.41563907 * u - 1.3546827) * u + 1.7751776) * u - 1.2969983) * u + 1.5002971) * u
        - 0.03925529;
    precise float code = roundEven(255.0 * (light <= 0.0031308 ? 12.92 * light : fit)) * 0.00392156862745;
    precise float base = (code + 0.055) * 0.947867298578;
    return code <= 0.04045 ? code * 0.0773993808050 : exact_pow(base, 2.4);
}

vec4 filter_srgb(vec4 texel)
{
    precise float alpha = roundEven(255.0 * texel.a) * 0.00392156862745;
    return vec4(filter_decode(texel.r), filter_decode(texel.g), filter_decode(texel.b), alpha);
}

/* p modulo n, 0 to n - 1. GLSL leaves the remainder of negative numbers open. */
int filter_modulo(int p, int n)
{
    return p < 0 ? n - 1 - (-1 - p) % n : p % n;
}

int filter_wrap(int p, int n, int wrap)
{
    int q = filter_modulo(p, 2 * n);
    return wrap == 1 ? filter_modulo(p, n) : wrap == 2 ? (q < n ? q : 2 * n - 1 - q) : clamp(p, 0, n - 1);
}

/* Mesa's CPU drivers take the level of one invocation for the textureSize of all. */
ivec2 filter_size(ivec2 finest, int level)
{
    return max(finest >> level, ivec2(1));
}

vec4 filter_texel(sampler2D image, ivec3 p, int level, int mode, vec4 border)
{
    ivec2 size = filter_size(textureSize(image, 0), level);
    ivec2 q = ivec2(filter_wrap(p.x, size.x, mode & 3), filter_wrap(p.y, size.y, mode & 3));
    vec4 texel = texelFetch(image, q, level);
    texel = (mode & 4) != 0 ? filter_srgb(texel) : texel;
    return (mode & 3) == 3 && q != p.xy ? border : texel;
}

vec4 filter_texel(sampler2DArray image, ivec3 p, int level, int mode, vec4 border)
{
    ivec3 finest = textureSize(image, 0);
    ivec2 size = filter_size(finest.xy, level);
    ivec2 q = ivec2(filter_wrap(p.x, size.x, mode & 3), filter_wrap(p.y, size.y, mode & 3));
    vec4 texel = texelFetch(image, ivec3(q, clamp(p.z, 0, finest.z - 1)), level);
    texel = (mode & 4) != 0 ? filter_srgb(texel) : texel;
    return (mode & 3) == 3 && q != p.xy ? border : texel;
}

vec4 filter_blend(vec4 a, vec4 b, float share)
{
    precise vec4 blend = a + (b - a) * share;
    return blend;
}

/* One level. place: uv, and the layer of an array; its layers are not filtered. */
vec4 filter_level(sampler2D image, vec3 place, int level, bool linear, int mode, vec4 border)
{
    ivec2 size = filter_size(textureSize(image, 0).xy, level);
    precise vec2 at = place.xy * vec2(size) - (linear ? 0.5 : 0.0);
    ivec3 p = ivec3(floor(at), roundEven(place.z));
    precise vec2 part = at - floor(at);
    vec4 a = filter_texel(image, p, level, mode, border);
    if (!linear)
        return a;
    vec4 b = filter_texel(image, p + ivec3(1, 0, 0), level, mode, border);
    vec4 c = filter_texel(image, p + ivec3(0, 1, 0), level, mode, border);
    vec4 d = filter_texel(image, p + ivec3(1, 1, 0), level, mode, border);
    return filter_blend(filter_blend(a, b, part.x), filter_blend(c, d, part.x), part.y);
}

vec4 filter_level(sampler2DArray image, vec3 place, int level, bool linear, int mode, vec4 border)
{
    ivec2 size = filter_size(textureSize(image, 0).xy, level);
    precise vec2 at = place.xy * vec2(size) - (linear ? 0.5 : 0.0);
    ivec3 p = ivec3(floor(at), roundEven(place.z));
    precise vec2 part = at - floor(at);
    vec4 a = filter_texel(image, p, level, mode, border);
    if (!linear)
        return a;
    vec4 b = filter_texel(image, p + ivec3(1, 0, 0), level, mode, border);
    vec4 c = filter_texel(image, p + ivec3(0, 1, 0), level, mode, border);
    vec4 d = filter_texel(image, p + ivec3(1, 1, 0), level, mode, border);
    return filter_blend(filter_blend(a, b, part.x), filter_blend(c, d, part.x), part.y);
}

vec4 filter_sample(sampler2D image, vec3 place, float lod, bool linear_mip, bool linear, int mode, vec4 border)
{
    int last = textureQueryLevels(image) - 1;
    float level = exact_clamp(lod, 0.0, float(last));
    if (!linear_mip)
        return filter_level(image, place, int(floor(level + 0.5)), linear, mode, border);
    int fine = int(floor(level));
    precise float share = level - floor(level);
    return filter_blend(filter_level(image, place, fine, linear, mode, border),
                        filter_level(image, place, min(fine + 1, last), linear, mode, border), share);
}

vec4 filter_sample(sampler2DArray image, vec3 place, float lod, bool linear_mip, bool linear, int mode, vec4 border)
{
    int last = textureQueryLevels(image) - 1;
    float level = exact_clamp(lod, 0.0, float(last));
    if (!linear_mip)
        return filter_level(image, place, int(floor(level + 0.5)), linear, mode, border);
    int fine = int(floor(level));
    precise float share = level - floor(level);
    return filter_blend(filter_level(image, place, fine, linear, mode, border),
                        filter_level(image, place, min(fine + 1, last), linear, mode, border), share);
}
