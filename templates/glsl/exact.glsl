/* Arithmetic that has the same bits on every device. GLSL and Vulkan round + - * correctly, and
 * comparisons, conversions and integer operations are exact; every other operation may err by
 * some units in the last place. So exact pipelines replace a call of NAME by exact_NAME, and a / b
 * by exact_divide(a, b), which are made of these operations alone, in a fixed order.
 * Inputs below 2^-126 count as zero, because a device may flush them. */

/* Component by component. */
#define exact_each(f) \
vec2 f(vec2 x) { return vec2(f(x.x), f(x.y)); } \
vec3 f(vec3 x) { return vec3(f(x.x), f(x.y), f(x.z)); } \
vec4 f(vec4 x) { return vec4(f(x.x), f(x.y), f(x.z), f(x.w)); }

#define exact_each_pair(f, V2, V3, V4) \
V2 f(V2 x, V2 y) { return V2(f(x.x, y.x), f(x.y, y.y)); } \
V3 f(V3 x, V3 y) { return V3(f(x.x, y.x), f(x.y, y.y), f(x.z, y.z)); } \
V4 f(V4 x, V4 y) { return V4(f(x.x, y.x), f(x.y, y.y), f(x.z, y.z), f(x.w, y.w)); }

#define exact_each_left(f, S, V2, V3, V4) \
V2 f(V2 x, S y) { return V2(f(x.x, y), f(x.y, y)); } \
V3 f(V3 x, S y) { return V3(f(x.x, y), f(x.y, y), f(x.z, y)); } \
V4 f(V4 x, S y) { return V4(f(x.x, y), f(x.y, y), f(x.z, y), f(x.w, y)); }

#define exact_each_right(f, S, V2, V3, V4) \
V2 f(S x, V2 y) { return V2(f(x, y.x), f(x, y.y)); } \
V3 f(S x, V3 y) { return V3(f(x, y.x), f(x, y.y), f(x, y.z)); } \
V4 f(S x, V4 y) { return V4(f(x, y.x), f(x, y.y), f(x, y.z), f(x, y.w)); }

/* 1 / y within 3e-6 for normal |y| up to 2^64: an integer subtraction estimates it (Moroz et al.
 * 2018), a polynomial in y r refines it. */
float exact_reciprocal_estimate(float y)
{
    float r = uintBitsToFloat(0x7eb50500u - floatBitsToUint(y));
    float d = y * r;
    r *= 4.17971835 - d * (5.82303075 - d * 2.70399363);
    return r;
}

/* 1 / y for |y| up to 2^64, by a Newton step. */
float exact_reciprocal(float y)
{
    float r = exact_reciprocal_estimate(y);
    float error = 1.0 - y * r;
    r += r * error;
    float end = uintBitsToFloat((floatBitsToUint(y) ^ 0x7f800000u) & 0xff800000u); /* of 0 and infinity */
    return abs(y) < 1.17549435e-38 || abs(y) > 3.40282347e38 ? end : r;
}

/* Keeps what lies between normal: 2^-64 for large |y|, else 1. */
float exact_scale(float y)
{
    return abs(y) > 18446744073709551616.0 ? 5.42101086242752217e-20 : 1.0;
}

#define exact_divide_by(T) \
T exact_divide(T x, float y) \
{ \
    float scale = exact_scale(y); \
    precise T q = (x * scale) * exact_reciprocal(y * scale); \
    return q; \
}

/* Where the generator does not see that both sides are integers. */
#define exact_divide_integers(S, V2, V3, V4) \
S exact_divide(S x, S y) { return x / y; } \
V2 exact_divide(V2 x, V2 y) { return x / y; } \
V2 exact_divide(V2 x, S y) { return x / y; } \
V2 exact_divide(S x, V2 y) { return x / y; } \
V3 exact_divide(V3 x, V3 y) { return x / y; } \
V3 exact_divide(V3 x, S y) { return x / y; } \
V3 exact_divide(S x, V3 y) { return x / y; } \
V4 exact_divide(V4 x, V4 y) { return x / y; } \
V4 exact_divide(V4 x, S y) { return x / y; } \
V4 exact_divide(S x, V4 y) { return x / y; }

float exact_divide(float x, float y)
{
    float scale = exact_scale(y);
    float q = (x * scale) * exact_reciprocal(y * scale);
    return q;
}
exact_each_pair(exact_divide, vec2, vec3, vec4);
exact_each_right(exact_divide, float, vec2, vec3, vec4);
exact_divide_by(vec2);
exact_divide_by(vec3);
exact_divide_by(vec4);
exact_divide_by(mat2);
exact_divide_by(mat2x3);
exact_divide_by(mat2x4);
exact_divide_by(mat3x2);
exact_divide_by(mat3);
exact_divide_by(mat3x4);
exact_divide_by(mat4x2);
exact_divide_by(mat4x3);
exact_divide_by(mat4);
exact_divide_integers(int, ivec2, ivec3, ivec4);
exact_divide_integers(uint, uvec2, uvec3, uvec4);

/* 1 / sqrt(x) within 2e-5, for positive normal x. */
float exact_root_estimate(float x)
{
    float r = uintBitsToFloat(0x5f200000u - (floatBitsToUint(x) >> 1));
    float d = x * r * r;
    r *= 2.102354969 - d * (1.760928667 - d * 0.6631531635);
    return r;
}

/* A value for positive normal x; negative x: all bits set, a NaN; zero and infinity: `end`. */
float exact_root_value(float x, float value, uint end)
{
    uint negative = uint(floatBitsToInt(x) >> 31);
    float root = uintBitsToFloat(floatBitsToUint(value) | negative);
    return abs(x) < 1.17549435e-38 || x > 3.40282347e38 ? uintBitsToFloat(end & 0xff800000u) : root;
}

float exact_inversesqrt(float x)
{
    float r = exact_root_estimate(x);
    float error = 1.0 - x * r * r;
    r += r * (0.5 * error);
    return exact_root_value(x, r, floatBitsToUint(x) ^ 0x7f800000u);
}
exact_each(exact_inversesqrt);

float exact_sqrt(float x)
{
    float r = exact_root_estimate(x);
    float s = x * r;
    float error = 1.0 - s * r;
    s += s * (0.5 * error);
    return exact_root_value(x, s, floatBitsToUint(x));
}
exact_each(exact_sqrt);

/* The quadrant of x, 0 to 3, and x less its multiple of pi / 2, within pi / 4. The parts of pi / 2
 * (Cody, Waite) have 8 bits: products with quadrants up to 2^16 are exact. Beyond |x| = 2^16 the
 * rest is wrong; it is cut to |r| <= 1. */
float exact_quadrant(float x, out float r)
{
    float n = roundEven(x * 0.636619772);
    r = x - n * 1.5703125;
    r -= n * 4.82559204e-4;
    r -= n * 1.26659870e-6;
    r -= n * 9.89530236e-10;
    r -= n * 2.56334407e-12;
    r = abs(r) > 1.0 ? 0.0 : r;
    return n - 4.0 * floor(n * 0.25);
}

/* Polynomials of Cephes (Moshier), for |r| <= pi / 4. */
float exact_sine(float r)
{
    float z = r * r;
    float p = (-1.9515295891e-4 * z + 8.3321608736e-3) * z - 1.6666654611e-1;
    float sine = p * z * r + r;
    return sine;
}

float exact_cosine(float r)
{
    float z = r * r;
    float p = (2.443315711809948e-5 * z - 1.388731625493765e-3) * z + 4.166664568298827e-2;
    float cosine = p * z * z - 0.5 * z + 1.0;
    return cosine;
}

float exact_sin(float x)
{
    float r;
    float quadrant = exact_quadrant(x, r);
    float s = quadrant == 1.0 || quadrant == 3.0 ? exact_cosine(r) : exact_sine(r);
    return quadrant >= 2.0 ? -s : s;
}
exact_each(exact_sin);

float exact_cos(float x)
{
    float r;
    float quadrant = exact_quadrant(x, r);
    float c = quadrant == 1.0 || quadrant == 3.0 ? exact_sine(r) : exact_cosine(r);
    return quadrant == 1.0 || quadrant == 2.0 ? -c : c;
}
exact_each(exact_cos);

float exact_tan(float x)
{
    float r;
    float quadrant = exact_quadrant(x, r);
    float s = exact_sine(r), c = exact_cosine(r);
    bool odd = quadrant == 1.0 || quadrant == 3.0;
    float above = odd ? -c : s, below = odd ? s : c;
    float q = exact_divide(above, below);
    float rest = above - q * below;
    q += exact_divide(rest, below);
    return q;
}
exact_each(exact_tan);

/* x 2^n for n from -252 to 254. */
float exact_ldexp_two(float x, int n)
{
    int half_n = n >> 1;
    x *= uintBitsToFloat(uint(half_n + 127) << 23);
    x *= uintBitsToFloat(uint(n - half_n + 127) << 23);
    return x;
}

/* 2^(n + f) for |f| <= 0.5. */
float exact_power_of_two(float n, float f)
{
    float p = (((((1.54699666e-4 * f + 1.33910965e-3) * f + 9.61803009e-3) * f + 5.55035667e-2) * f + 2.40226511e-1) * f
        + 6.93147188e-1) * f + 1.0;
    return exact_ldexp_two(p, int(n));
}

float exact_exp2(float x)
{
    x = x > 160.0 ? 160.0 : x < -160.0 ? -160.0 : x;
    float n = roundEven(x);
    float f = x - n;
    return exact_power_of_two(n, f);
}
exact_each(exact_exp2);

float exact_exp(float x)
{
    x = x > 110.0 ? 110.0 : x < -110.0 ? -110.0 : x;
    float n = roundEven(x * 1.44269504);
    float r = x - n * 0.693359375;
    r += n * 2.12194440e-4;
    float p = (((1.3941379554e-3 * r + 8.36333528e-3) * r + 4.16663723e-2) * r + 1.66665760e-1) * r + 0.5;
    p = p * (r * r) + r + 1.0;
    return exact_ldexp_two(p, int(n));
}
exact_each(exact_exp);

/* m and n with x = m 2^n, sqrt(1/2) <= m < sqrt(2), for positive normal x. */
float exact_mantissa(float x, out float n)
{
    uint above = floatBitsToUint(x) - 0x3f3504f3u;
    n = float(int(above) >> 23);
    return uintBitsToFloat((above & 0x007fffffu) + 0x3f3504f3u);
}

/* Values that a logarithm has at the ends: of zero, infinity, NaN and negative numbers. */
float exact_log_end(float x, float logarithm)
{
    float infinity = uintBitsToFloat(0x7f800000u);
    logarithm = x <= 3.40282347e38 ? logarithm : x;
    return abs(x) < 1.17549435e-38 ? -infinity : x < 0.0 ? uintBitsToFloat(0x7fc00000u) : logarithm;
}

/* log(1 + t) - t, after Cephes' logf. */
float exact_log_rest(float t)
{
    float z = t * t;
    float p = (((((((7.0376836292e-2 * t - 1.1514610310e-1) * t + 1.1676998740e-1) * t - 1.2420140846e-1) * t
        + 1.4249322787e-1) * t - 1.6668057665e-1) * t + 2.0000714765e-1) * t - 2.4999993993e-1) * t + 3.3333331174e-1;
    float rest = t * z * p - 0.5 * z;
    return rest;
}

float exact_log(float x)
{
    float n;
    float t = exact_mantissa(x, n) - 1.0;
    float rest = exact_log_rest(t) - n * 2.12194440e-4;
    float logarithm = rest + t + n * 0.693359375;
    return exact_log_end(x, logarithm);
}
exact_each(exact_log);

float exact_log2(float x)
{
    float n;
    float t = exact_mantissa(x, n) - 1.0;
    float rest = exact_log_rest(t);
    float logarithm = rest * 0.442695041 + t * 0.442695041 + rest + t + n;
    return exact_log_end(x, logarithm);
}
exact_each(exact_log2);

/* The upper 12 bits of a mantissa: products of two such numbers are exact. */
float exact_upper(float x)
{
    return uintBitsToFloat(floatBitsToUint(x) & 0xfffff000u);
}

/* x^y = 2^(y log2(x)), the logarithm and the product as sums of an upper and a lower part, as in
 * fdlibm's e_powf.c: log2(m) = 2 / ln(2) atanh((m - 1) / (m + 1)). NaN for negative x. */
float exact_pow(float x, float y)
{
    y = abs(y) < 1.17549435e-38 ? 0.0 : y;
    float n;
    float m = exact_mantissa(x, n);
    float r = exact_reciprocal(m + 1.0);
    float ratio = (m - 1.0) * r;
    float s = exact_upper(ratio);
    float d = exact_upper(m + 1.0);
    float below = m - (d - 1.0); /* m + 1 = d + below */
    float s_low = ((m - 1.0 - s * d) - s * below) * r;
    float all = s + s_low;
    float z = all * all;
    float series = (((0.1166606973 * z + 0.1427537773) * z + 0.2000006123) * z + 0.3333333328) * z * all;
    float high = 2.88476562 * s;
    float low = 0.000624456778 * s + 2.88539008 * (s_low + series);
    float sum = n + high;
    low += high - (sum - n);
    high = exact_upper(sum + low);
    low += sum - high;
    float by = y > 1e12 ? 1e12 : y < -1e12 ? -1e12 : y;
    float by_high = exact_upper(by);
    float p_low = (by - by_high) * high + by * low;
    float p = by_high * high;
    float power = p + p_low;
    power = power > 160.0 ? 160.0 : power < -160.0 ? -160.0 : power;
    float whole = roundEven(power);
    float f = (p - whole) + p_low;
    f = abs(power) < 160.0 ? f : 0.0;
    power = exact_power_of_two(whole, f);
    float infinity = uintBitsToFloat(0x7f800000u);
    power = x > 3.40282347e38 ? y > 0.0 ? infinity : 0.0 : power;
    power = abs(x) < 1.17549435e-38 ? y > 0.0 ? 0.0 : infinity : x < 0.0 || x != x || y != y ? uintBitsToFloat(0x7fc00000u) : power;
    return y == 0.0 ? 1.0 : power;
}
exact_each_pair(exact_pow, vec2, vec3, vec4);

/* A constant that compilers do not fold: they fold in double, or in float. */
#define exact_value_of(T) \
T exact_value(T x) { return x; }

float exact_value(float x)
{
    return x;
}
exact_value_of(vec2);
exact_value_of(vec3);
exact_value_of(vec4);
exact_value_of(mat2);
exact_value_of(mat3);
exact_value_of(mat4);

/* Where the generator does not see that arguments are integers. */
#define exact_integers(f, g, S, V2, V3, V4) \
S f(S x, S y) { return g(x, y); } \
V2 f(V2 x, V2 y) { return g(x, y); } \
V3 f(V3 x, V3 y) { return g(x, y); } \
V4 f(V4 x, V4 y) { return g(x, y); } \
V2 f(V2 x, S y) { return g(x, y); } \
V3 f(V3 x, S y) { return g(x, y); } \
V4 f(V4 x, S y) { return g(x, y); }

float exact_min(float x, float y)
{
    return x < y ? x : y;
}
exact_each_pair(exact_min, vec2, vec3, vec4);
exact_each_left(exact_min, float, vec2, vec3, vec4);
exact_integers(exact_min, min, int, ivec2, ivec3, ivec4);
exact_integers(exact_min, min, uint, uvec2, uvec3, uvec4);

float exact_max(float x, float y)
{
    return x > y ? x : y;
}
exact_each_pair(exact_max, vec2, vec3, vec4);
exact_each_left(exact_max, float, vec2, vec3, vec4);
exact_integers(exact_max, max, int, ivec2, ivec3, ivec4);
exact_integers(exact_max, max, uint, uvec2, uvec3, uvec4);

#define exact_clamp_of(T, S) \
T exact_clamp(T x, S low, S high) { return exact_min(exact_max(x, low), high); }

#define exact_clamp_integers(S, V2, V3, V4) \
S exact_clamp(S x, S low, S high) { return clamp(x, low, high); } \
V2 exact_clamp(V2 x, V2 low, V2 high) { return clamp(x, low, high); } \
V3 exact_clamp(V3 x, V3 low, V3 high) { return clamp(x, low, high); } \
V4 exact_clamp(V4 x, V4 low, V4 high) { return clamp(x, low, high); } \
V2 exact_clamp(V2 x, S low, S high) { return clamp(x, low, high); } \
V3 exact_clamp(V3 x, S low, S high) { return clamp(x, low, high); } \
V4 exact_clamp(V4 x, S low, S high) { return clamp(x, low, high); }

float exact_clamp(float x, float low, float high)
{
    return exact_min(exact_max(x, low), high);
}
exact_clamp_of(vec2, vec2);
exact_clamp_of(vec3, vec3);
exact_clamp_of(vec4, vec4);
exact_clamp_of(vec2, float);
exact_clamp_of(vec3, float);
exact_clamp_of(vec4, float);
exact_clamp_integers(int, ivec2, ivec3, ivec4);
exact_clamp_integers(uint, uvec2, uvec3, uvec4);

float exact_fract(float x)
{
    return x - floor(x);
}
exact_each(exact_fract);

/* The quotient may be one off; the rest tells. */
float exact_mod(float x, float y)
{
    float rest = x - y * floor(exact_divide(x, y));
    bool below = y > 0.0 ? rest < 0.0 : rest > 0.0;
    bool above = y > 0.0 ? rest >= y : rest <= y;
    return below ? rest + y : above ? rest - y : rest;
}
exact_each_pair(exact_mod, vec2, vec3, vec4);
exact_each_left(exact_mod, float, vec2, vec3, vec4);

float exact_round(float x)
{
    return roundEven(x);
}
exact_each(exact_round);

float exact_fma(float a, float b, float c)
{
    return a * b + c;
}

vec2 exact_fma(vec2 a, vec2 b, vec2 c)
{
    return a * b + c;
}

vec3 exact_fma(vec3 a, vec3 b, vec3 c)
{
    return a * b + c;
}

vec4 exact_fma(vec4 a, vec4 b, vec4 c)
{
    return a * b + c;
}

float exact_degrees(float x)
{
    return x * 57.2957795;
}
exact_each(exact_degrees);

float exact_radians(float x)
{
    return x * 0.0174532925;
}
exact_each(exact_radians);

float exact_smoothstep(float low, float high, float x)
{
    float t = exact_clamp(exact_divide(x - low, high - low), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

vec2 exact_smoothstep(vec2 low, vec2 high, vec2 x)
{
    return vec2(exact_smoothstep(low.x, high.x, x.x), exact_smoothstep(low.y, high.y, x.y));
}

vec3 exact_smoothstep(vec3 low, vec3 high, vec3 x)
{
    return vec3(exact_smoothstep(low.xy, high.xy, x.xy), exact_smoothstep(low.z, high.z, x.z));
}

vec4 exact_smoothstep(vec4 low, vec4 high, vec4 x)
{
    return vec4(exact_smoothstep(low.xy, high.xy, x.xy), exact_smoothstep(low.zw, high.zw, x.zw));
}

vec2 exact_smoothstep(float low, float high, vec2 x)
{
    return exact_smoothstep(vec2(low), vec2(high), x);
}

vec3 exact_smoothstep(float low, float high, vec3 x)
{
    return exact_smoothstep(vec3(low), vec3(high), x);
}

vec4 exact_smoothstep(float low, float high, vec4 x)
{
    return exact_smoothstep(vec4(low), vec4(high), x);
}

/* Results below 2^-125 may be zero. */
float exact_ldexp(float x, int n)
{
    return exact_ldexp_two(x, clamp(n, -254, 254));
}

vec2 exact_ldexp(vec2 x, ivec2 n)
{
    return vec2(exact_ldexp(x.x, n.x), exact_ldexp(x.y, n.y));
}

vec3 exact_ldexp(vec3 x, ivec3 n)
{
    return vec3(exact_ldexp(x.xy, n.xy), exact_ldexp(x.z, n.z));
}

vec4 exact_ldexp(vec4 x, ivec4 n)
{
    return vec4(exact_ldexp(x.xy, n.xy), exact_ldexp(x.zw, n.zw));
}

/* Hyperbolic functions: near zero Cephes' polynomials, else by powers of e. */
float exact_sinh(float x)
{
    float a = abs(x);
    float z = x * x;
    float p = ((2.03721912945e-4 * z + 8.33028376239e-3) * z + 1.66667160211e-1) * z * x + x;
    float e = exact_exp(0.5 * a); /* its square may overflow */
    float half_e = 0.5 * e;
    float power = half_e * e - exact_divide(exact_divide(0.5, e), e);
    power = x < 0.0 ? -power : power;
    return a > 1.0 ? power : x != x ? x : p;
}
exact_each(exact_sinh);

float exact_cosh(float x)
{
    float e = exact_exp(0.5 * abs(x));
    float half_e = 0.5 * e;
    return half_e * e + exact_divide(exact_divide(0.5, e), e);
}
exact_each(exact_cosh);

float exact_tanh(float x)
{
    float a = abs(x);
    float z = x * x;
    float p = ((((-5.70498872745e-3 * z + 2.06390887954e-2) * z - 5.37397155531e-2) * z + 1.33314422036e-1) * z
        - 3.33332819422e-1) * z * x + x;
    float power = 1.0 - exact_divide(2.0, exact_exp(2.0 * a) + 1.0);
    power = x < 0.0 ? -power : power;
    return a > 0.625 ? power : p;
}
exact_each(exact_tanh);

float exact_asinh(float x)
{
    float a = abs(x);
    float z = a * a;
    float p = (((2.0122003309e-2 * z - 4.2699340972e-2) * z + 7.4847586088e-2) * z - 1.6666288134e-1) * z * a + a;
    float far = exact_log(a) + 0.693147181;
    float near = exact_log(a + exact_sqrt(z + 1.0));
    float r = a > 1e9 ? far : a > 0.5 ? near : p;
    return x < 0.0 ? -r : x != x ? x : r;
}
exact_each(exact_asinh);

float exact_acosh(float x)
{
    float z = x - 1.0;
    float p = (((1.7596881071e-3 * z - 7.5272886713e-3) * z + 2.6454905019e-2) * z - 1.1784741703e-1) * z + 1.4142135263;
    float near = p * exact_sqrt(z);
    float far = exact_log(x) + 0.693147181;
    float square = z * (x + 1.0);
    float r = exact_log(x + exact_sqrt(square));
    return x > 1e9 ? far : z < 0.5 ? near : r;
}
exact_each(exact_acosh);

float exact_atanh(float x)
{
    float z = x * x;
    float p = ((((1.81740078349e-1 * z + 8.24370301058e-2) * z + 1.46691431730e-1) * z + 1.99782164500e-1) * z
        + 3.33337300303e-1) * z * x + x;
    float r = 0.5 * exact_log(exact_divide(1.0 + x, 1.0 - x));
    return abs(x) < 0.5 ? p : r;
}
exact_each(exact_atanh);

/* Arc tangent of low / high for 0 <= low <= high, after Cephes' atanf: one reduction around 1, then
 * an odd polynomial. */
float exact_atan_ratio(float low, float high)
{
    bool upper = low > 0.414213562 * high;
    float t = exact_divide(upper ? low - high : low, upper ? low + high : high);
    float z = t * t;
    float p = ((8.05374449538e-2 * z - 1.38776856032e-1) * z + 1.99777106478e-1) * z - 3.33329491539e-1;
    float r = p * z * t + t;
    return upper ? r + 0.785398163 : r;
}

float exact_atan(float x)
{
    float a = abs(x);
    float r = exact_atan_ratio(a > 1.0 ? 1.0 : a, a > 1.0 ? a : 1.0);
    r = a > 1.0 ? 1.57079633 - r : r;
    return x < 0.0 ? -r : r;
}
exact_each(exact_atan);

float exact_atan(float y, float x)
{
    float a = abs(x), b = abs(y);
    bool steep = b > a;
    float r = exact_atan_ratio(steep ? a : b, steep ? b : a);
    r = a + b < 1.17549435e-38 ? 0.0 : steep ? 1.57079633 - r : r;
    r = x < 0.0 ? 3.14159265 - r : r;
    return y < 0.0 ? -r : r;
}
exact_each_pair(exact_atan, vec2, vec3, vec4);

/* Arc sine of 0..0.5, after Cephes' asinf. z is the square of x. */
float exact_asin_half(float x, float z)
{
    float p = (((4.2163199048e-2 * z + 2.4181311049e-2) * z + 4.5470025998e-2) * z + 7.4953002686e-2) * z
        + 1.6666752422e-1;
    return p * z * x + x;
}

float exact_asin(float x)
{
    float a = abs(x);
    bool upper = a > 0.5;
    float z = upper ? 0.5 * (1.0 - a) : a * a;
    float r = exact_asin_half(upper ? exact_sqrt(z) : a, z);
    float angle = upper ? 1.57079633 - 2.0 * r : r;
    return x < 0.0 ? -angle : angle;
}
exact_each(exact_asin);

float exact_acos(float x)
{
    float a = abs(x);
    bool upper = a > 0.5;
    float z = upper ? 0.5 * (1.0 - a) : a * a;
    float r = exact_asin_half(upper ? exact_sqrt(z) : a, z);
    float from_pole = 2.0 * r;
    float outer = x < 0.0 ? 3.14159265 - from_pole : from_pole;
    float inner = x < 0.0 ? 1.57079633 + r : 1.57079633 - r;
    return upper ? outer : inner;
}
exact_each(exact_acos);

float exact_dot(float a, float b)
{
    return a * b;
}

float exact_dot(vec2 a, vec2 b)
{
    return a.x * b.x + a.y * b.y;
}

float exact_dot(vec3 a, vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

float exact_dot(vec4 a, vec4 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
}

vec3 exact_cross(vec3 a, vec3 b)
{
    return a.yzx * b.zxy - a.zxy * b.yzx;
}

#define exact_length_of(T) \
float exact_length(T v) { return exact_sqrt(exact_dot(v, v)); }

float exact_length(float v)
{
    return abs(v);
}
exact_length_of(vec2);
exact_length_of(vec3);
exact_length_of(vec4);

#define exact_distance_of(T) \
float exact_distance(T a, T b) \
{ \
    precise T d = a - b; \
    return exact_length(d); \
}

float exact_distance(float a, float b)
{
    return exact_length(a - b);
}
exact_distance_of(vec2);
exact_distance_of(vec3);
exact_distance_of(vec4);

#define exact_normalize_of(T) \
T exact_normalize(T v) \
{ \
    precise T unit = v * exact_inversesqrt(exact_dot(v, v)); \
    return unit; \
}

float exact_normalize(float v)
{
    return sign(v);
}
exact_normalize_of(vec2);
exact_normalize_of(vec3);
exact_normalize_of(vec4);

#define exact_choice(S, V2, V3, V4) \
S exact_mix(S x, S y, bool a) { return a ? y : x; } \
V2 exact_mix(V2 x, V2 y, bvec2 a) { return V2(a.x ? y.x : x.x, a.y ? y.y : x.y); } \
V3 exact_mix(V3 x, V3 y, bvec3 a) { return V3(a.x ? y.x : x.x, a.y ? y.y : x.y, a.z ? y.z : x.z); } \
V4 exact_mix(V4 x, V4 y, bvec4 a) \
{ \
    return V4(a.x ? y.x : x.x, a.y ? y.y : x.y, a.z ? y.z : x.z, a.w ? y.w : x.w); \
}

#define exact_mix_of(T, S) \
T exact_mix(T x, T y, S a) \
{ \
    precise T blend = x * (1.0 - a) + y * a; \
    return blend; \
}

float exact_mix(float x, float y, float a)
{
    return x * (1.0 - a) + y * a;
}
exact_mix_of(vec2, float);
exact_mix_of(vec2, vec2);
exact_mix_of(vec3, float);
exact_mix_of(vec3, vec3);
exact_mix_of(vec4, float);
exact_mix_of(vec4, vec4);
exact_choice(float, vec2, vec3, vec4);
exact_choice(int, ivec2, ivec3, ivec4);
exact_choice(uint, uvec2, uvec3, uvec4);
exact_choice(bool, bvec2, bvec3, bvec4);

#define exact_reflect_of(T) \
T exact_reflect(T i, T n) \
{ \
    precise T mirrored = i - n * (2.0 * exact_dot(n, i)); \
    return mirrored; \
}

float exact_reflect(float i, float n)
{
    return i - n * (2.0 * exact_dot(n, i));
}
exact_reflect_of(vec2);
exact_reflect_of(vec3);
exact_reflect_of(vec4);

#define exact_refract_of(T) \
T exact_refract(T i, T n, float eta) \
{ \
    precise float cosine = exact_dot(n, i); \
    precise float k = 1.0 - eta * eta * (1.0 - cosine * cosine); \
    precise T bent = i * eta - n * (eta * cosine + exact_sqrt(exact_max(k, 0.0))); \
    return k < 0.0 ? T(0.0) : bent; \
}

float exact_refract(float i, float n, float eta)
{
    float cosine = exact_dot(n, i);
    float k = 1.0 - eta * eta * (1.0 - cosine * cosine);
    float bent = i * eta - n * (eta * cosine + exact_sqrt(exact_max(k, 0.0)));
    return k < 0.0 ? 0.0 : bent;
}
exact_refract_of(vec2);
exact_refract_of(vec3);
exact_refract_of(vec4);

#define exact_faceforward_of(T) \
T exact_faceforward(T n, T i, T reference) { return exact_dot(reference, i) < 0.0 ? n : -n; }

float exact_faceforward(float n, float i, float reference)
{
    return exact_dot(reference, i) < 0.0 ? n : -n;
}
exact_faceforward_of(vec2);
exact_faceforward_of(vec3);
exact_faceforward_of(vec4);

float exact_determinant(mat2 m)
{
    return m[0].x * m[1].y - m[1].x * m[0].y;
}

float exact_determinant(mat3 m)
{
    return exact_dot(m[0], exact_cross(m[1], m[2]));
}

/* By the minors of the upper and of the lower two rows. */
float exact_determinant(mat4 m)
{
    vec3 upper = vec3(m[0].x, m[0].x, m[0].x) * vec3(m[1].y, m[2].y, m[3].y) - vec3(m[1].x, m[2].x, m[3].x) * m[0].y;
    vec3 upper_rest = exact_cross(vec3(m[1].x, m[2].x, m[3].x), vec3(m[1].y, m[2].y, m[3].y));
    vec3 lower = vec3(m[0].z, m[0].z, m[0].z) * vec3(m[1].w, m[2].w, m[3].w) - vec3(m[1].z, m[2].z, m[3].z) * m[0].w;
    vec3 lower_rest = exact_cross(vec3(m[1].z, m[2].z, m[3].z), vec3(m[1].w, m[2].w, m[3].w));
    return exact_dot(upper, lower_rest) + exact_dot(upper_rest, lower);
}

mat2 exact_inverse(mat2 m)
{
    return exact_divide(mat2(m[1].y, -m[0].y, -m[1].x, m[0].x), exact_determinant(m));
}

mat3 exact_inverse(mat3 m)
{
    mat3 rows = mat3(exact_cross(m[1], m[2]), exact_cross(m[2], m[0]), exact_cross(m[0], m[1]));
    return exact_divide(transpose(rows), exact_dot(m[0], rows[0]));
}

/* Each column of the adjugate is the cross product of three rows, in four dimensions. */
vec4 exact_cofactors(vec4 a, vec4 b, vec4 c)
{
    return vec4(exact_determinant(mat3(a.yzw, b.yzw, c.yzw)), -exact_determinant(mat3(a.xzw, b.xzw, c.xzw)),
                exact_determinant(mat3(a.xyw, b.xyw, c.xyw)), -exact_determinant(mat3(a.xyz, b.xyz, c.xyz)));
}

mat4 exact_inverse(mat4 m)
{
    vec4 first = exact_cofactors(m[1], m[2], m[3]);
    mat4 rows = mat4(first, -exact_cofactors(m[0], m[2], m[3]), exact_cofactors(m[0], m[1], m[3]),
                     -exact_cofactors(m[0], m[1], m[2]));
    return exact_divide(transpose(rows), exact_dot(m[0], first));
}

/* To the nearest half, ties to even. */
uint exact_half(float x)
{
    uint bits = floatBitsToUint(x);
    uint a = bits & 0x7fffffffu;
    uint small = uint(roundEven(uintBitsToFloat(min(a, 0x38800000u)) * 16777216.0));
    uint normal = (a - 0x38000000u + 0xfffu + (a >> 13 & 1u)) >> 13;
    uint finite = a < 0x38800000u ? small : normal;
    uint h = a > 0x7f800000u ? 0x7e00u : a > 0x477fefffu ? 0x7c00u : finite;
    return (bits >> 16 & 0x8000u) | h;
}

float exact_from_half(uint h)
{
    uint a = (h & 0x7fffu) << 13;
    uint small = floatBitsToUint(float(h & 0x3ffu) * 5.96046448e-8);
    uint bits = a < 0x00800000u ? small : a < 0x0f800000u ? a + 0x38000000u : a | 0x7f800000u;
    return uintBitsToFloat(bits | (h & 0x8000u) << 16);
}

uint exact_packHalf2x16(vec2 v)
{
    return exact_half(v.x) | exact_half(v.y) << 16;
}

vec2 exact_unpackHalf2x16(uint p)
{
    return vec2(exact_from_half(p & 0xffffu), exact_from_half(p >> 16));
}

uint exact_packUnorm2x16(vec2 v)
{
    uvec2 u = uvec2(roundEven(exact_clamp(v, 0.0, 1.0) * 65535.0));
    return u.x | u.y << 16;
}

uint exact_packUnorm4x8(vec4 v)
{
    uvec4 u = uvec4(roundEven(exact_clamp(v, 0.0, 1.0) * 255.0));
    return u.x | u.y << 8 | u.z << 16 | u.w << 24;
}

uint exact_packSnorm2x16(vec2 v)
{
    uvec2 u = uvec2(ivec2(roundEven(exact_clamp(v, -1.0, 1.0) * 32767.0))) & 0xffffu;
    return u.x | u.y << 16;
}

uint exact_packSnorm4x8(vec4 v)
{
    uvec4 u = uvec4(ivec4(roundEven(exact_clamp(v, -1.0, 1.0) * 127.0))) & 0xffu;
    return u.x | u.y << 8 | u.z << 16 | u.w << 24;
}

vec2 exact_unpackUnorm2x16(uint p)
{
    return exact_divide(vec2(uvec2(p, p >> 16) & 0xffffu), 65535.0);
}

vec4 exact_unpackUnorm4x8(uint p)
{
    return exact_divide(vec4(uvec4(p, p >> 8, p >> 16, p >> 24) & 0xffu), 255.0);
}

vec2 exact_unpackSnorm2x16(uint p)
{
    ivec2 i = ivec2(uvec2(p << 16, p)) >> 16;
    return exact_max(exact_divide(vec2(i), 32767.0), -1.0);
}

vec4 exact_unpackSnorm4x8(uint p)
{
    ivec4 i = ivec4(uvec4(p << 24, p << 16, p << 8, p)) >> 24;
    return exact_max(exact_divide(vec4(i), 127.0), -1.0);
}

/* Sums, differences and products that `precise` does not reach in OpenGL's GLSL text. The generator does not know types:
 * these are all, but for products of two matrices that are not square. */
#define exact_operation(f, o, T, A, B) \
T f(A a, B b) \
{ \
    precise T value = a o b; \
    return value; \
}

#define exact_vector_operation(f, o, T, S) \
exact_operation(f, o, T, T, T) \
exact_operation(f, o, T, T, S) \
exact_operation(f, o, T, S, T)

#define exact_operations(f, o, S, V2, V3, V4) \
exact_operation(f, o, S, S, S) \
exact_vector_operation(f, o, V2, S) \
exact_vector_operation(f, o, V3, S) \
exact_vector_operation(f, o, V4, S)

#define exact_matrix_operations(f, o) \
exact_vector_operation(f, o, mat2, float) \
exact_vector_operation(f, o, mat2x3, float) \
exact_vector_operation(f, o, mat2x4, float) \
exact_vector_operation(f, o, mat3x2, float) \
exact_vector_operation(f, o, mat3, float) \
exact_vector_operation(f, o, mat3x4, float) \
exact_vector_operation(f, o, mat4x2, float) \
exact_vector_operation(f, o, mat4x3, float) \
exact_vector_operation(f, o, mat4, float)

/* With vectors of as many components as M has columns, C, and rows, R. */
#define exact_matrix_product(M, C, R) \
R exact_multiply(M m, C v) \
{ \
    precise R value = m[0] * v[0]; \
    for (int i = 1; i < m.length(); i++) \
        value += m[i] * v[i]; \
    return value; \
} \
C exact_multiply(R v, M m) \
{ \
    precise C value; \
    for (int i = 0; i < m.length(); i++) \
        value[i] = exact_dot(v, m[i]); \
    return value; \
} \
M exact_multiply(M m, float s) \
{ \
    for (int i = 0; i < m.length(); i++) \
        m[i] = exact_multiply(m[i], s); \
    return m; \
} \
M exact_multiply(float s, M m) { return exact_multiply(m, s); }

#define exact_square_product(M) \
M exact_multiply(M a, M b) \
{ \
    M value; \
    for (int i = 0; i < a.length(); i++) \
        value[i] = exact_multiply(a, b[i]); \
    return value; \
}

#ifdef GL_SPIRV
#define exact_add(a, b) ((a) + (b))
#else
exact_operations(exact_add, +, float, vec2, vec3, vec4);
exact_operations(exact_add, +, int, ivec2, ivec3, ivec4);
exact_operations(exact_add, +, uint, uvec2, uvec3, uvec4);
exact_matrix_operations(exact_add, +);
#endif

#ifdef GL_SPIRV
#define exact_subtract(a, b) ((a) - (b))
#else
exact_operations(exact_subtract, -, float, vec2, vec3, vec4);
exact_operations(exact_subtract, -, int, ivec2, ivec3, ivec4);
exact_operations(exact_subtract, -, uint, uvec2, uvec3, uvec4);
exact_matrix_operations(exact_subtract, -);
#endif

#ifdef GL_SPIRV
#define exact_multiply(a, b) ((a) * (b))
#else
exact_operations(exact_multiply, *, float, vec2, vec3, vec4);
exact_operations(exact_multiply, *, int, ivec2, ivec3, ivec4);
exact_operations(exact_multiply, *, uint, uvec2, uvec3, uvec4);
exact_matrix_product(mat2, vec2, vec2);
exact_matrix_product(mat2x3, vec2, vec3);
exact_matrix_product(mat2x4, vec2, vec4);
exact_matrix_product(mat3x2, vec3, vec2);
exact_matrix_product(mat3, vec3, vec3);
exact_matrix_product(mat3x4, vec3, vec4);
exact_matrix_product(mat4x2, vec4, vec2);
exact_matrix_product(mat4x3, vec4, vec3);
exact_matrix_product(mat4, vec4, vec4);
exact_square_product(mat2);
exact_square_product(mat3);
exact_square_product(mat4);
#endif
