/* Filtering of images in floats, by texel fetches: the same bits on every device, whose own filters
 * round weights to a few bits. What NAME_sample and NAME_sample_lod of exact pipelines call. The
 * generator has a macro define the functions of each image, with what its sampler needs and nothing
 * else: drivers take long over code that they remove later. */

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

vec4 filter_plain(vec4 texel)
{
    return texel;
}

/* p modulo n, 0 to n - 1. GLSL leaves the remainder of negative numbers open. */
int filter_modulo(int p, int n)
{
    return p < 0 ? n - 1 - (-1 - p) % n : p % n;
}

int filter_clamp(int p, int n)
{
    return clamp(p, 0, n - 1);
}

int filter_repeat(int p, int n)
{
    return filter_modulo(p, n);
}

int filter_mirror(int p, int n)
{
    int q = filter_modulo(p, 2 * n);
    return q < n ? q : 2 * n - 1 - q;
}

/* Mesa's CPU drivers take the level of one invocation for the textureSize of all. */
ivec2 filter_size(ivec2 finest, int level)
{
    return max(finest >> level, ivec2(1));
}

vec4 filter_blend(vec4 a, vec4 b, float share)
{
    precise vec4 blend = a + (b - a) * share;
    return blend;
}

/* Texel q; layers of arrays end as edges do. */
#define filter_2D(image, q, layer) q

#define filter_2DArray(image, q, layer) ivec3(q, clamp(layer, 0, textureSize(image, 0).z - 1))

/* A texel: `place` is one of the two above, `decode` filter_srgb or filter_plain. */
#define filter_texel(NAME, SAMPLER, place, decode, wrap) \
vec4 NAME(SAMPLER image, ivec3 p, int level, vec4 border) \
{ \
    ivec2 size = filter_size(textureSize(image, 0).xy, level); \
    ivec2 q = ivec2(wrap(p.x, size.x), wrap(p.y, size.y)); \
    return decode(texelFetch(image, place(image, q, p.z), level)); \
}

/* With a border outside. */
#define filter_border(NAME, SAMPLER, place, decode, wrap) \
vec4 NAME(SAMPLER image, ivec3 p, int level, vec4 border) \
{ \
    ivec2 size = filter_size(textureSize(image, 0).xy, level); \
    ivec2 q = ivec2(wrap(p.x, size.x), wrap(p.y, size.y)); \
    return q != p.xy ? border : decode(texelFetch(image, place(image, q, p.z), level)); \
}

/* One level. at: uv, and the layer of an array; its layers are not filtered. */
#define filter_nearest(NAME, SAMPLER, texel) \
vec4 NAME(SAMPLER image, vec3 at, int level, vec4 border) \
{ \
    ivec2 size = filter_size(textureSize(image, 0).xy, level); \
    precise vec2 place = at.xy * vec2(size); \
    return texel(image, ivec3(floor(place), roundEven(at.z)), level, border); \
}

#define filter_linear(NAME, SAMPLER, texel) \
vec4 NAME(SAMPLER image, vec3 at, int level, vec4 border) \
{ \
    ivec2 size = filter_size(textureSize(image, 0).xy, level); \
    precise vec2 place = at.xy * vec2(size) - 0.5; \
    precise vec2 part = place - floor(place); \
    ivec3 p = ivec3(floor(place), roundEven(at.z)); \
    vec4 a = texel(image, p, level, border); \
    vec4 b = texel(image, p + ivec3(1, 0, 0), level, border); \
    vec4 c = texel(image, p + ivec3(0, 1, 0), level, border); \
    vec4 d = texel(image, p + ivec3(1, 1, 0), level, border); \
    return filter_blend(filter_blend(a, b, part.x), filter_blend(c, d, part.x), part.y); \
}

/* All levels. */
#define filter_nearest_mip(NAME, SAMPLER, level_of) \
vec4 NAME(SAMPLER image, vec3 at, float lod, vec4 border) \
{ \
    float level = exact_clamp(lod, 0.0, float(textureQueryLevels(image) - 1)); \
    return level_of(image, at, int(floor(level + 0.5)), border); \
}

#define filter_linear_mip(NAME, SAMPLER, level_of) \
vec4 NAME(SAMPLER image, vec3 at, float lod, vec4 border) \
{ \
    int last = textureQueryLevels(image) - 1; \
    float level = exact_clamp(lod, 0.0, float(last)); \
    int fine = int(floor(level)); \
    precise float share = level - floor(level); \
    return filter_blend(level_of(image, at, fine, border), level_of(image, at, min(fine + 1, last), border), share); \
}
