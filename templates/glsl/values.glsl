/* What texels hold: part of the library of exact pipelines, see exact.glsl. gen/spirv/values.c calls these functions around reads
 * and writes of images, by their format, and on what fragment shaders leave.
 *
 * Drivers read the codes of fixed-point formats to an ulp, some as code / most, some as code * (1 / most): NVIDIA's two APIs differ. They
 * decode sRGB to a few bits. So the code is found again from what they give. They may round stores towards zero; a value that the format
 * holds leaves them no choice. */

/* ---- Reads ----------------------------------------------------------------------------------- */

/* code / most, the nearest float for every code: code + code / most is most + 1 times that, and is rounded once. `step` is
 * 1 / most, `share` 1 / (most + 1). */
vec4 decode_fixed(const vec4 texel, const vec4 most, const vec4 step, const vec4 share)
{
    vec4 code = roundEven(texel * most);
    return (code + code * step) * share;
}

#define DECODE_FIXED(format, most, step, share) \
vec4 decode_##format(const vec4 texel) { return decode_fixed(texel, most, step, share); }

DECODE_FIXED(unorm8, vec4(255.0), vec4(1.0 / 255.0), vec4(1.0 / 256.0))
DECODE_FIXED(unorm16, vec4(65535.0), vec4(1.0 / 65535.0), vec4(1.0 / 65536.0))
DECODE_FIXED(snorm16, vec4(32767.0), vec4(1.0 / 32767.0), vec4(1.0 / 32768.0)) /* the two least codes are -1 */
DECODE_FIXED(rgb10a2, vec4(vec3(1023.0), 3.0), vec4(vec3(1.0 / 1023.0), 1.0 / 3.0), vec4(vec3(1.0 / 1024.0), 0.25))

/* sRGB of 8 bits (IEC 61966-2-1). share: code / 255. A fit of the decoding is 4e-5 off, relative: 0.006 codes. */
float decode_share(const float code)
{
    float share = code * 0.00392156862745;
    float slope = (((((0.138861712 * share - 0.393694139) * share + 0.48188816) * share - 0.394731246) * share
        + 0.481365721) * share + 0.963586398) * share + 0.999152309;
    float decoded = (share - 1.0) * slope + 1.0;
    return mix(decoded, share * 0.0773993808050, code <= 10.0);
}

/* A fit of the encoding finds the code, 0.12 codes off. `r` is 1 / sqrt(light) within 2e-5. */
float decode_light(const float light)
{
    float r = uintBitsToFloat(0x5f200000u - (floatBitsToUint(light) >> 1));
    float d = light * r * r;
    r = r * (2.102354969 - d * (1.760928667 - d * 0.6631531635));
    float u = light * r;
    float fit = ((((105.98796 * u - 345.44409) * u + 452.67029) * u - 330.73457) * u + 382.57576) * u - 10.010099;
    return decode_share(roundEven(mix(fit, 3294.6 * light, light <= 0.0031308))); /* codes up to 10 */
}

vec4 decode_srgb(const vec4 texel)
{
    return vec4(decode_light(texel.r), decode_light(texel.g), decode_light(texel.b), decode_unorm8(texel).a);
}

/* sRGB that the driver has not decoded. */
vec4 decode_codes(const vec4 texel)
{
    vec3 code = roundEven(texel.rgb * 255.0);
    return vec4(decode_share(code.r), decode_share(code.g), decode_share(code.b), decode_unorm8(texel).a);
}

/* ---- Writes ---------------------------------------------------------------------------------- */

/* Float formats of 5 bits of exponent and 23 - 13 = 10 (half), 6 or 5 bits of mantissa. `shift` is
 * 23 less the bits of the mantissa, at its place in the exponent. Adding and subtracting a power of
 * two whose last bit is the result's last bit rounds. Takes and returns the bits of magnitudes. */
uvec4 store_round(const uvec4 bits, const uvec4 shift)
{
    vec4 grid = uintBitsToFloat(max(bits & 0x7f800000u, uvec4(0x38800000u)) + shift);
    vec4 sum = uintBitsToFloat(bits) + grid;
    vec4 rounded = sum - grid;
    return floatBitsToUint(rounded);
}

/* Finite values beyond the largest, 65504: the largest, as not every driver stores an infinity. */
vec4 store_half(const vec4 value)
{
    uvec4 bits = floatBitsToUint(value);
    ivec4 magnitude = ivec4(bits & 0x7fffffffu);
    uvec4 rounded = store_round(uvec4(min(magnitude, 0x477fe000)), uvec4(13u << 23));
    rounded = mix(rounded, uvec4(magnitude), greaterThanEqual(magnitude, ivec4(0x7f800000)));
    return uintBitsToFloat(rounded | (bits & 0x80000000u));
}

/* Negative values: 0. Finite values beyond the largest: the largest. */
vec4 store_r11g11b10(const vec4 value)
{
    uvec4 bits = floatBitsToUint(value);
    uvec4 rounded = store_round(bits, uvec4(17u << 23, 17u << 23, 18u << 23, 17u << 23));
    uvec4 most = uvec4(0x477e0000u, 0x477e0000u, 0x477c0000u, 0x477e0000u);
    rounded = mix(rounded, most, greaterThan(bits, most));
    rounded = mix(rounded, bits, greaterThanEqual(bits, uvec4(0x7f800000u)));
    return uintBitsToFloat(mix(rounded, uvec4(0u), greaterThan(bits, uvec4(0x7fffffffu))));
}

/* Fixed point: `most` is the largest code, `step` its reciprocal. 2^-20 more than the code's own value gives the code whether
 * the driver rounds or truncates. NaN: 0. */
vec4 store_fixed(const vec4 value, const vec4 most, const vec4 step)
{
    vec4 positive = mix(vec4(0.0), value, greaterThan(value, vec4(0.0)));
    vec4 inside = mix(positive, vec4(1.0), greaterThan(positive, vec4(1.0)));
    vec4 stored = roundEven(inside * most) * step + 9.5367431640625e-7;
    return stored;
}

#define STORE_FIXED(format, most, step) \
vec4 store_##format(const vec4 value) { return store_fixed(value, most, step); }

STORE_FIXED(unorm8, vec4(255.0), vec4(1.0 / 255.0))
STORE_FIXED(unorm16, vec4(65535.0), vec4(1.0 / 65535.0))
STORE_FIXED(rgb10a2, vec4(vec3(1023.0), 3.0), vec4(vec3(1.0 / 1023.0), 1.0 / 3.0))

vec4 store_snorm16(const vec4 value)
{
    vec4 magnitude = store_fixed(abs(value), vec4(32767.0), vec4(1.0 / 32767.0));
    return mix(magnitude, -magnitude, lessThan(value, vec4(0.0)));
}

/* Integers beyond the codes: the nearest code, where some drivers keep the low bits. */
#define STORE_UINT(bits, most) \
uvec4 store_uint##bits(const uvec4 value) { return min(value, uvec4(most)); }
#define STORE_INT(bits, least, most) \
ivec4 store_int##bits(const ivec4 value) { return clamp(value, ivec4(least), ivec4(most)); }

STORE_UINT(8, 255u)
STORE_UINT(16, 65535u)
STORE_INT(8, -128, 127)
STORE_INT(16, -32768, 32767)
