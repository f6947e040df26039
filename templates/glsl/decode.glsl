/* The values of texels. Drivers read the codes of fixed-point formats to an ulp, some as code / most, some as
 * code * (1 / most): NVIDIA's two APIs differ. They decode sRGB to a few bits. So the code is found again from
 * what they give. The generator calls these functions around reads of exact pipelines. */

vec4 decode_plain(vec4 texel)
{
    return texel;
}

/* code / most, the nearest float for every code: code + code / most is most + 1 times that, and is rounded once. `step` is
 * 1 / most, `share` 1 / (most + 1). */
vec4 decode_fixed(vec4 texel, vec4 most, vec4 step, vec4 share)
{
    vec4 code = roundEven(texel * most);
    precise vec4 value = (code + code * step) * share;
    return value;
}

vec4 decode_unorm8(vec4 texel)
{
    return decode_fixed(texel, vec4(255.0), vec4(1.0 / 255.0), vec4(1.0 / 256.0));
}

vec4 decode_unorm16(vec4 texel)
{
    return decode_fixed(texel, vec4(65535.0), vec4(1.0 / 65535.0), vec4(1.0 / 65536.0));
}

/* The two least codes are -1. */
vec4 decode_snorm16(vec4 texel)
{
    return decode_fixed(texel, vec4(32767.0), vec4(1.0 / 32767.0), vec4(1.0 / 32768.0));
}

vec4 decode_rgb10a2(vec4 texel)
{
    return decode_fixed(texel, vec4(vec3(1023.0), 3.0), vec4(vec3(1.0 / 1023.0), 1.0 / 3.0), vec4(vec3(1.0 / 1024.0), 0.25));
}

/* sRGB of 8 bits (IEC 61966-2-1). A fit of the encoding finds the code, 0.12 codes off; a fit of the decoding is 4e-5 off,
 * relative: 0.006 codes. */
float decode_light(float light)
{
    precise float u = light * approximate_root_estimate(light);
    precise float fit = ((((105.98796 * u - 345.44409) * u + 452.67029) * u - 330.73457) * u + 382.57576) * u
        - 10.010099;
    bool straight = light <= 0.0031308; /* codes up to 10 */
    precise float code = roundEven(straight ? 3294.6 * light : fit) * 0.00392156862745;
    precise float slope = (((((0.138861712 * code - 0.393694139) * code + 0.48188816) * code - 0.394731246) * code
        + 0.481365721) * code + 0.963586398) * code + 0.999152309;
    precise float decoded = (code - 1.0) * slope + 1.0;
    return straight ? code * 0.0773993808050 : decoded;
}

vec4 decode_srgb(vec4 texel)
{
    return vec4(decode_light(texel.r), decode_light(texel.g), decode_light(texel.b), decode_unorm8(texel).a);
}
