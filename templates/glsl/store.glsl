/* Values as an image of a narrow format holds them: nearest, ties to even. Drivers may round stores
 * otherwise, for example towards zero; a value that the format holds leaves them no choice. The
 * generator calls these functions before stores and at the end of fragment shaders of exact
 * pipelines. */

/* Float formats of 5 bits of exponent and 23 - 13 = 10 (half), 6 or 5 bits of mantissa. `shift` is
 * 23 less the bits of the mantissa, at its place in the exponent. Adding and subtracting a power of
 * two whose last bit is the result's last bit rounds. Takes and returns the bits of magnitudes. */
uvec4 store_round(uvec4 bits, uvec4 shift)
{
    vec4 grid = uintBitsToFloat(max(bits & 0x7f800000u, uvec4(0x38800000u)) + shift);
    precise vec4 sum = uintBitsToFloat(bits) + grid;
    precise vec4 rounded = sum - grid;
    return floatBitsToUint(rounded);
}

/* Finite values beyond the largest, 65504: the largest, as not every driver stores an infinity. */
vec4 store_half(vec4 value)
{
    uvec4 bits = floatBitsToUint(value);
    uvec4 magnitude = bits & 0x7fffffffu;
    uvec4 rounded = store_round(magnitude, uvec4(13u << 23));
    rounded = mix(rounded, uvec4(0x477fe000u), greaterThan(magnitude, uvec4(0x477fe000u)));
    rounded = mix(rounded, magnitude, greaterThanEqual(magnitude, uvec4(0x7f800000u)));
    return uintBitsToFloat(rounded | (bits & 0x80000000u));
}

/* Negative values: 0. Finite values beyond the largest: the largest. */
vec4 store_r11g11b10(vec4 value)
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
vec4 store_unorm(vec4 value, vec4 most, vec4 step)
{
    vec4 positive = mix(vec4(0.0), value, greaterThan(value, vec4(0.0)));
    vec4 inside = mix(positive, vec4(1.0), greaterThan(positive, vec4(1.0)));
    precise vec4 stored = roundEven(inside * most) * step + 9.5367431640625e-7;
    return stored;
}

vec4 store_snorm(vec4 value, vec4 most, vec4 step)
{
    vec4 magnitude = store_unorm(abs(value), most, step);
    return mix(magnitude, -magnitude, lessThan(value, vec4(0.0)));
}
