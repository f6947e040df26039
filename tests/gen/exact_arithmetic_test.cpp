/* The scalar functions of templates/glsl/exact.glsl, compiled as C++ and held against the CPU: `/` and
 * sqrt bit by bit, the others by identities; exact_accuracy.py has their errors on devices.
 * DIPTYCH_LONG takes 10^8 pairs. With a seed: short forms against whole functions, over the ranges that
 * `diptych-gen --prove` states (prove_test.sh). TAP. */
#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <iostream>
#include <string>
#include <type_traits>
#include <vector>

typedef uint32_t uint;

namespace
{

float uintBitsToFloat(uint bits)
{
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

uint floatBitsToUint(float x)
{
    uint bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

int floatBitsToInt(float x)
{
    return (int)floatBitsToUint(x);
}

float roundEven(float x)
{
    return rintf(x);
}

int clamp(int x, int low, int high)
{
    return x < low ? low : x > high ? high : x;
}

/* Of floats a float, although a literal is a double here. */
template <typename A, typename B> auto mix(A x, B y, bool second)
{
    using common = std::common_type_t<A, B>;
    using type = std::conditional_t<std::is_floating_point_v<common>, float, common>;
    return second ? (type)y : (type)x;
}

/* As many components as the library's scalars need. */
struct vec2 {
    float x, y;
    explicit vec2(float a) : x(a), y(a)
    {
    }
    vec2(double a, double b) : x((float)a), y((float)b)
    {
    }
};

struct uvec2 {
    uint x, y;
    explicit uvec2(uint a) : x(a), y(a)
    {
    }
    uvec2(uint a, uint b) : x(a), y(b)
    {
    }
};

struct bvec2 {
    bool x, y;
    bvec2(bool a, bool b) : x(a), y(b)
    {
    }
};

struct bvec3 {
    bool x, y, z;
    bvec3(bool a, bool b, bool c) : x(a), y(b), z(c)
    {
    }
};

uvec2 operator-(uvec2 a, uint b)
{
    return uvec2(a.x - b, a.y - b);
}

bvec2 equal(vec2 a, vec2 b)
{
    return bvec2(a.x == b.x, a.y == b.y);
}

bvec2 equal(uvec2 a, uvec2 b)
{
    return bvec2(a.x == b.x, a.y == b.y);
}

bvec2 greaterThan(uvec2 a, uvec2 b)
{
    return bvec2(a.x > b.x, a.y > b.y);
}

bvec2 greaterThanEqual(uvec2 a, uvec2 b)
{
    return bvec2(a.x >= b.x, a.y >= b.y);
}

bool any(bvec2 b)
{
    return b.x || b.y;
}

bool any(bvec3 b)
{
    return b.x || b.y || b.z;
}

bool all(bvec2 b)
{
    return b.x && b.y;
}

using std::abs;
using std::floor;
using std::max;
using std::min;
float min(float x, float y)
{
    return fminf(x, y);
} /* of zeros either, as NMin */
float max(float x, float y)
{
    return fmaxf(x, y);
}

#include "exact_scalars.h" /* made of templates/glsl/exact.glsl by the build */

/* ---- Inputs ---------------------------------------------------------------------------------- */

uint64_t state = 88172645463325252ull; /* xorshift, Marsaglia 2003 */

uint random_bits()
{
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return (uint)(state >> 16);
}

float random_mantissa() /* 1 to 2 */
{
    return uintBitsToFloat((random_bits() & 0x7fffffu) | 0x3f800000u);
}

float random_in(float low, float high)
{
    return low + (high - low) * (random_mantissa() - 1.0f);
}

/* As the library counts inputs and results: what is no normal number is zero. */
float normal(float x)
{
    return fabsf(x) < 1.17549435e-38f ? copysignf(0.0f, x) : x;
}

bool same(float a, float b)
{
    return (std::isnan(a) && std::isnan(b)) || floatBitsToUint(a) == floatBitsToUint(b);
}

int number, failures;

void report(bool good, const char *what)
{
    printf("%sok %d - %s\n", good ? "" : "not ", ++number, what);
    failures += !good;
}

/* ---- Division and square root ---------------------------------------------------------------- */

unsigned wrong;

void divide(float x, float y)
{
    float wanted = normal(normal(x) / normal(y)), found = exact_divide(x, y);
    if (!same(found, wanted) && wrong++ < 5)
        printf("# %a / %a is %a, not %a\n", (double)x, (double)y, (double)wanted, (double)found);
}

/* y: 12 bits, at least 1, as exact.c calls it. */
void divide_short(float x, float y)
{
    float wanted = normal(normal(x) / y), found = exact_divide_constant(x, y);
    if (!same(found, wanted) && wrong++ < 5)
        printf("# %a / constant %a is %a, not %a\n", (double)x, (double)y, (double)wanted,
               (double)found);
}

void root(float x)
{
    float wanted = sqrtf(normal(x)), found = exact_sqrt(x);
    if (!same(found, wanted) && wrong++ < 5)
        printf("# sqrt(%a) is %a, not %a\n", (double)x, (double)wanted, (double)found);
}

void divide_random(long count)
{
    for (long i = 0; i < count; i++) {
        uint a = random_bits(), b = random_bits();
        if (i % 3 == 0) { /* of the same exponent */
            a = (a & 0x807fffffu) | 0x3f800000u;
            b = (b & 0x807fffffu) | 0x3f800000u;
        }
        if (i % 7 == 0) /* quotients near 1 */
            b = a + random_bits() % 64 - 32;
        divide(uintBitsToFloat(a), uintBitsToFloat(b));
        root(uintBitsToFloat(a));
    }
}

/* Quotients as close to half-way between two floats as there are, and their neighbours. */
void divide_hard(long count)
{
    for (long i = 0; i < count; i++) {
        float y = random_mantissa(), q = random_mantissa();
        float x = (float)(((double)q + 0x1p-24) * (double)y);
        divide(x, y);
        divide(nextafterf(x, 0.0f), y);
        divide(nextafterf(x, 9.0f), y);
    }
}

void divide_ends()
{
    static const uint ends[] = {0,          0x80000000, 0x7f800000, 0xff800000, 0x7fc00000,
                                0x7f800001, 0x00800000, 0x80800000, 0x7f7fffff, 0x3f800000,
                                0x00000001, 0x007fffff, 0x3f7fffff, 0x34000000, 0x00800001};
    for (uint a : ends) {
        root(uintBitsToFloat(a));
        for (uint b : ends)
            divide(uintBitsToFloat(a), uintBitsToFloat(b));
    }
    for (int exponent = -126; exponent < 128; exponent++) /* around the ends of the range */
        for (int other = -126; other < 128; other++)
            divide(ldexpf(random_mantissa(), exponent), ldexpf(random_mantissa(), other));
}

/* All mantissas of 12 bits: random numbers, quotients next to half-way, the ends of the range. */
void divide_constants()
{
    static const uint ends[] = {0,          0x80000000, 0x7f800000, 0xff800000, 0x7fc00000,
                                0x7f7fffff, 0x00800000, 0x80800001, 0x007fffff, 0x00000001};
    for (uint m = 0; m < 2048; m++) {
        float y = uintBitsToFloat(0x3f800000u | m << 12);
        for (int i = 0; i < 300; i++) {
            float by = ldexpf(random_bits() % 2 ? y : -y, (int)(random_bits() % 127));
            float x = (float)(((double)random_mantissa() + 0x1p-24) * (double)y);
            divide_short(uintBitsToFloat(random_bits()), by);
            divide_short(x, y);
            divide_short(nextafterf(x, 0.0f), by);
        }
        for (uint end : ends)
            divide_short(uintBitsToFloat(end), y);
    }
}

bool whole_quotients()
{
    for (int n = 1; n <= 600; n++)
        for (int k = 1; k <= 600; k++)
            if (exact_divide((float)(k * n), (float)n) != (float)k)
                return false;
    return true;
}

void test_division(long count)
{
    divide_random(count);
    report(!wrong, "quotients and roots of random numbers are those of the CPU");
    divide_hard(count / 4);
    report(!wrong, "so are quotients next to half-way between two floats");
    divide_ends();
    report(!wrong, "so are those of zeros, infinities, NaN and the ends of the range");
    divide_constants();
    report(!wrong, "so are quotients by constants of 12 bits");
    for (uint m = 0; m < 0x1000000u; m++)
        root(uintBitsToFloat(0x3f800000u + m));
    report(!wrong, "so are the roots of all mantissas");
    report(whole_quotients(), "(k n) / n is k");
}

/* ---- Other functions ------------------------------------------------------------------------- */

bool identities()
{
    for (int i = 0; i < 1000000; i++) {
        float x = uintBitsToFloat(random_bits()), y = uintBitsToFloat(random_bits());
        float part = exact_fract(random_in(-1e-3f, 1e-3f));
        if (std::isnan(x) || std::isnan(y) || std::isinf(x) || std::isinf(y))
            continue;
        if (!(part >= 0.0f && part < 1.0f) || exact_mix(x, y, 1.0f) != y ||
            exact_mix(x, y, 0.0f) != x || exact_divide(y, y) != (normal(y) != 0.0f ? 1.0f : NAN) ||
            (x > 0.0f && normal(x) == x && exact_pow(x, 1.0f) != x))
            if (normal(y) != 0.0f)
                return false;
    }
    return true;
}

bool remainders()
{
    for (int i = 0; i < 2000000; i++) {
        float n = (float)(1 + random_bits() % (i % 2 ? 4096 : 8388608)),
              k = (float)(random_bits() % 16777216);
        float rest = exact_mod(k, n);
        if (rest != fmodf(k, n))
            return false;
        float below = exact_mod(-k, n), wanted = fmodf(k, n);
        if (below != (wanted == 0.0f ? 0.0f : n - wanted))
            return false;
    }
    return true;
}

bool powers_of_negatives()
{
    return exact_pow(-2.0f, 2.0f) == 4.0f && exact_pow(-2.0f, 3.0f) == -8.0f &&
           exact_pow(-1.0f, 17.0f) == -1.0f && std::isnan(exact_pow(-2.0f, 0.5f)) &&
           exact_pow(-3.0f, 0.0f) == 1.0f && exact_pow(0.0f, 2.0f) == 0.0f;
}

bool monotonic(float (*f)(float), float low, float high)
{
    float last = f(low);
    for (uint bits = floatBitsToUint(low); bits < floatBitsToUint(high); bits++) {
        float value = f(uintBitsToFloat(bits));
        if (value < last)
            return false;
        last = value;
    }
    return true;
}

bool conversions()
{
    return exact_to_int(3e9f) == 2147483647 && exact_to_int(-3e9f) == -2147483647 - 1 &&
           exact_to_int(NAN) == 0 && exact_to_int(-1.9f) == -1 && exact_to_uint(5e9f) == ~0u &&
           exact_to_uint(-1.0f) == 0 && exact_to_uint(NAN) == 0 &&
           exact_to_uint(4294967040.0f) == 4294967040u && exact_to_int(INFINITY) == 2147483647;
}

/* A device's minimum and maximum: a number wins over NaN; of two zeros it takes any. */
float extreme(float x, float y, bool most, bool first)
{
    if (std::isnan(x) || std::isnan(y) || x == y)
        return std::isnan(x) ? y : std::isnan(y) ? x : first ? x : y;
    return (x > y) == most ? x : y;
}

bool chooses()
{
    const float numbers[] = {0.0f, -0.0f, 1.0f, -1.0f, 2.0f, INFINITY, -INFINITY, NAN, -NAN};
    for (float x : numbers)
        for (float y : numbers)
            if (!same(exact_min(x, y), extreme(x, y, false, std::signbit(x))) ||
                !same(exact_max(x, y), extreme(x, y, true, !std::signbit(x))) ||
                !same(exact_clamp(x, -1.0f, 1.0f), fminf(fmaxf(x, -1.0f), 1.0f)) ||
                exact_step(x, y) != (y < x ? 0.0f : 1.0f))
                return false;
    return true;
}

bool not_numbers()
{
    return exact_isnan(NAN) && !exact_isnan(INFINITY) && exact_isinf(-INFINITY) &&
           !exact_isinf(3.4e38f) && exact_smoothstep(0.0f, 1.0f, NAN) == 0.0f;
}

/* ---- Short forms ----------------------------------------------------------------------------- */

/* `LOW to HIGH or -0 or NaN`: the ends, what is next to them, and random numbers between; no denormals. */
std::vector<float> samples_of(const std::string &text)
{
    bool any = text.compare(0, 3, "any") == 0, has_zero = text.find(" or -0") != std::string::npos;
    size_t to = text.find(" to ");
    float low = any ? -INFINITY : strtof(text.c_str(), nullptr);
    float high = any ? INFINITY : to == std::string::npos ? low : strtof(&text[to + 4], nullptr);
    std::vector<float> found, all = {low, high, 0.0f, -0.0f, 1.0f, -1.0f, FLT_MIN, -FLT_MIN};
    for (float end : {low, high, 0x1p31f, -0x1p31f, 0x1p32f, INFINITY, -INFINITY})
        for (float other : {-INFINITY, INFINITY})
            all.push_back(nextafterf(end, other));
    for (int i = 0; i < 400; i++)
        all.push_back(i % 2 ? uintBitsToFloat(random_bits())
                            : random_in(fmaxf(low, -1e5f), fminf(high, 1e5f)));
    for (float x : all)
        if (x >= low && x <= high && normal(x) == x && (x != 0.0f || has_zero || !std::signbit(x)))
            found.push_back(x);
    if (text.find(" or NaN") != std::string::npos)
        found.push_back(NAN);
    return found;
}

/* Whether an operation's short form, by its name, gives what the whole one does. first: which of two zeros. */
bool agrees(const std::string &form, float a, float b, float c, bool first)
{
    const uint outside = 0x5eed5eedu; /* of what no integer has */
    if (form == "max: instruction")
        return same(extreme(a, b, true, first), exact_max(a, b));
    if (form == "min: instruction")
        return same(extreme(a, b, false, first), exact_min(a, b));
    if (form == "clamp: instruction")
        return same(extreme(extreme(a, b, true, first), c, false, first), exact_clamp(a, b, c));
    if (form == "max: constant")
        return same(exact_max_constant(a, b), exact_max(a, b));
    if (form == "clamp: constant")
        return same(exact_clamp_constant(a, b, c), exact_clamp(a, b, c));
    if (form == "divide: constant")
        return same(exact_divide_constant(a, b), exact_divide(a, b));
    if (form == "divide: product")
        return same(normal(normal(a) * (1.0f / b)), exact_divide(a, b));
    if (form == "to_int: instruction")
        return (a >= -0x1p31f && a < 0x1p31f ? (uint)(int)a : outside) == (uint)exact_to_int(a);
    return form == "to_uint: instruction" &&
           (a > -1.0f && a < 0x1p32f ? (uint)a : outside) == exact_to_uint(a);
}

/* A line `WORD: FORM, of OPERAND; ...` */
bool holds(const std::string &line)
{
    std::vector<float> samples[3] = {{0.0f}, {0.0f}, {0.0f}};
    size_t of = line.find(", of "), count = 0;
    for (size_t at = of + 5, end; at < line.size() && count < 3; at = end + 2) {
        end = std::min(line.find("; ", at), line.size());
        samples[count++] = samples_of(line.substr(at, end - at));
    }
    const std::string form = line.substr(0, of);
    if (form == "max: constant" && line[of + 5] != 'a') /* the constant comes last */
        std::swap(samples[0], samples[1]);
    for (long i = 0; i < 200000; i++) {
        float x[3];
        for (int k = 0; k < 3; k++)
            x[k] =
                samples[k][random_bits() % std::min(samples[k].size(), (size_t)(i % 2 ? 20 : 500))];
        if (!agrees(form, x[0], x[1], x[2], i % 3 == 0)) {
            printf("# %a %a %a: %s\n", (double)x[0], (double)x[1], (double)x[2], line.c_str());
            return false;
        }
    }
    return true;
}

/* Lines from the standard input. */
int check_forms(uint64_t seed)
{
    bool good = true;
    state += seed;
    printf("# SEED=%llu\n", (unsigned long long)seed);
    for (std::string line; std::getline(std::cin, line);)
        good = holds(line) && good;
    report(good, "short forms have the bits of the whole functions");
    printf("1..%d\n", number);
    return failures != 0;
}

} // namespace

int main(int count, char **words)
{
    if (count > 1)
        return check_forms(strtoull(words[1], nullptr, 10));
    bool all = getenv("DIPTYCH_LONG");
    test_division(all ? 100000000 : 2000000);
    report(identities(), "x / x is 1, mix ends at its ends, fract stays below 1, pow(x, 1) is x");
    report(remainders(), "mod of whole numbers below 2^24 is whole, and that of C");
    report(powers_of_negatives(), "powers of negative numbers by whole exponents");
    report(monotonic(exact_sqrt, 1.0f, 1.25f) && monotonic(exact_exp2, 0.4f, 0.6f) &&
               monotonic(exact_log2, 1.3f, 1.5f),
           "sqrt, exp2 and log2 never fall");
    report(conversions(), "float to integer saturates");
    report(chooses(), "min, max and clamp are those of IEEE 754-2019, step is 1 for NaN");
    report(not_numbers(), "NaN and infinity where they are defined");
    printf("1..%d\n", number);
    return failures != 0;
}
