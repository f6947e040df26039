/* Cheap functions for hot loops: division and roots that need no last bit, and functions of arguments in
 * known ranges. As many operations as a device's own, and the same bits on every device. Errors in
 * units in the last place (ulp), for normal operands and results and |y| up to 2^64. With
 * `exactness: fast` these are the device's own. */

#define approximate_each(f) \
vec2 f(const vec2 x) { return vec2(f(x.x), f(x.y)); } \
vec3 f(const vec3 x) { return vec3(f(x.x), f(x.y), f(x.z)); } \
vec4 f(const vec4 x) { return vec4(f(x.x), f(x.y), f(x.z), f(x.w)); }

/* max(x, least) for x that is no NaN and least that is not negative: numbers from 0 on are ordered as
 * their bits are. */
float approximate_max(const float x, const float least)
{
#ifdef EXACT
    return intBitsToFloat(max(floatBitsToInt(x), floatBitsToInt(least)));
#else
    return max(x, least);
#endif
}

/* clamp(x, 0.0, most) for the same. */
float approximate_clamp(const float x, const float most)
{
#ifdef EXACT
    return intBitsToFloat(clamp(floatBitsToInt(x), 0, floatBitsToInt(most)));
#else
    return clamp(x, 0.0, most);
#endif
}

/* int(x) for whole numbers up to 2^22: a sum with 1.5 * 2^23 has them in its lowest bits. */
int approximate_int(const float x)
{
#ifdef EXACT
    return floatBitsToInt(x + 12582912.0) - 0x4b400000;
#else
    return int(x);
#endif
}

/* 1 / y within 3e-6, for normal |y| up to 2^64: an integer subtraction estimates it (Moroz et al.
 * 2018), a polynomial in y r refines it. */
float approximate_reciprocal_estimate(const float y)
{
#ifdef EXACT
    float r = uintBitsToFloat(0x7eb50500u - floatBitsToUint(y));
    float d = y * r;
    return r * (4.17971835 - d * (5.82303075 - d * 2.70399363));
#else
    return 1.0 / y;
#endif
}

/* 1 / y within 2 ulp; of zero and infinity: infinity and zero. */
float approximate_reciprocal(const float y)
{
    float r = approximate_reciprocal_estimate(y);
    float error = 1.0 - y * r;
    r += r * error;
    float end = uintBitsToFloat((floatBitsToUint(y) ^ 0x7f800000u) & 0xff800000u);
    return abs(y) < 1.17549435e-38 || abs(y) > 3.40282347e38 ? end : r;
}

/* x / y within 2 ulp. */
float approximate_divide(const float x, const float y)
{
    return x * approximate_reciprocal(y);
}

vec2 approximate_divide(const vec2 x, const float y)
{
    return x * approximate_reciprocal(y);
}

vec3 approximate_divide(const vec3 x, const float y)
{
    return x * approximate_reciprocal(y);
}

vec4 approximate_divide(const vec4 x, const float y)
{
    return x * approximate_reciprocal(y);
}

/* 1 / sqrt(x) within 2e-5, for positive normal x. */
float approximate_root_estimate(const float x)
{
#ifdef EXACT
    float r = uintBitsToFloat(0x5f200000u - (floatBitsToUint(x) >> 1));
    float d = x * r * r;
    return r * (2.102354969 - d * (1.760928667 - d * 0.6631531635));
#else
    return inversesqrt(x);
#endif
}

/* A value for positive normal x; negative x: all bits set, a NaN; zero and infinity: `end`. */
float approximate_root_value(const float x, const float value, const uint end)
{
    uint negative = uint(floatBitsToInt(x) >> 31);
    float root = uintBitsToFloat(floatBitsToUint(value) | negative);
    return abs(x) < 1.17549435e-38 || x > 3.40282347e38 ? uintBitsToFloat(end & 0xff800000u) : root;
}

/* Within 2 ulp. */
float approximate_inversesqrt(const float x)
{
    float r = approximate_root_estimate(x);
    float error = 1.0 - x * r * r;
    r += r * (0.5 * error);
    return approximate_root_value(x, r, floatBitsToUint(x) ^ 0x7f800000u);
}
approximate_each(approximate_inversesqrt)

/* Within 2 ulp. */
float approximate_sqrt(const float x)
{
    float r = approximate_root_estimate(x);
    float s = x * r;
    float error = 1.0 - s * r;
    s += s * (0.5 * error);
    return approximate_root_value(x, s, floatBitsToUint(x));
}
approximate_each(approximate_sqrt)

vec2 approximate_normalize(const vec2 v)
{
    return v * approximate_inversesqrt(dot(v, v));
}

vec3 approximate_normalize(const vec3 v)
{
    return v * approximate_inversesqrt(dot(v, v));
}

vec4 approximate_normalize(const vec4 v)
{
    return v * approximate_inversesqrt(dot(v, v));
}
