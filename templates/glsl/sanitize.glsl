/* Checks of --sanitize. gen/spirv/sanitize.c calls them before the operations of a body; the generator appends this file to
 * each stage, with the functions that have no body here. A check computes with integers alone or compares, so it changes no
 * result.
 *
 * site: where the author wrote it, what: which operation. Both are indices of model->sites; they differ where a generated
 * function, like NAME_store(), holds the operation and the author calls it. */

/* Place of the invocation, and extent of all of them. */
#if defined(VERTEX)
uvec3 diptych_place() { return uvec3(gl_VertexIndex, gl_InstanceIndex, 0); }
uvec3 diptych_extent() { return uvec3(1048576, 4096, 1); }
#elif defined(FRAGMENT)
uvec3 diptych_place() { return uvec3(gl_FragCoord.xy, 0.0); }
uvec3 diptych_extent() { return uvec3(65536, 65536, 1); }
#else
uvec3 diptych_place_at(const uvec3 group, const uvec3 local) { return @place@; }
uvec3 diptych_place() { return diptych_place_at(gl_WorkGroupID, gl_LocalInvocationID); }
uvec3 diptych_extent() { return diptych_place_at(gl_NumWorkGroups, uvec3(0)); }
#endif
uint diptych_now(); /* the frame's index + 1 */
uint diptych_frame_size(); /* width and height in half a word each */

/* The call of a generated function that runs. */
uint diptych_caller = 0u;

/* Per site 200 words: count, ~(least invocation), records, frame + 1, two extents, lost findings of others, 0; then 16 records of 12 words:
 * ~invocation, what, four values. */
layout(std430, @layout@) coherent buffer Diptych_reports {
    uint diptych_reports[];
};

/* What an invocation has found: the first one of each room, and how often. Operations of a pass take @free@ rooms in turn; those of
 * a kind that the pass allows have a room of their own. `what` of a check is the site times 32, and the room. Drivers inline every
 * check, so a check only selects; diptych_flush() reports, once, behind the body. */
struct Diptych_found {
    uint site, what, times; /* site + 1; 0: nothing */
    uint a, b, c, d;
};
Diptych_found diptych_found[@rooms@] = Diptych_found[](@nothing@);

/* All findings, but of kinds that are allowed. What is not in a room when the body ends had none. */
uint diptych_lost = 0u;

bool diptych_note(const bool bad, const uint site, const uint what)
{
    uint room = what & 31u;
    bool fresh = all(bvec2(bad, diptych_found[room].site == 0u));
    diptych_found[room].site = mix(diptych_found[room].site, site + 1u, fresh);
    diptych_found[room].what = mix(diptych_found[room].what, what, fresh);
    diptych_found[room].times += uint(all(bvec2(bad, diptych_found[room].what == what)));
    diptych_lost += uint(all(bvec2(bad, room < @free@u)));
    return fresh;
}

bool diptych_told(const bool bad, const uint a, const uint b, const uint site, const uint what)
{
    bool fresh = diptych_note(bad, site, what);
    diptych_found[what & 31u].a = mix(diptych_found[what & 31u].a, a, fresh);
    diptych_found[what & 31u].b = mix(diptych_found[what & 31u].b, b, fresh);
    return bad;
}

/* Counts. An invocation of the first frame that is less than all before leaves a record; the host takes the least one's. There
 * is no lock: Mesa 22's llvmpipe loses lanes behind a loop that waits. */
void diptych_report(const uint key, const Diptych_found found)
{
    uint slot = 200u * (found.site - 1u), now = diptych_now();
    uvec3 extent = diptych_extent();
    if (found.site == 0u)
        return;
    atomicAdd(diptych_reports[slot], found.times);
    atomicAdd(diptych_reports[slot + 6u], diptych_lost);
    diptych_lost = 0u; /* told once */
    uint first = atomicCompSwap(diptych_reports[slot + 3u], 0u, now);
    if ((first != 0u && first != now) || key <= atomicMax(diptych_reports[slot + 1u], key))
        return;
    uint record = slot + 8u + 12u * (atomicAdd(diptych_reports[slot + 2u], 1u) % 16u);
    diptych_reports[slot + 4u] = extent.x;
    diptych_reports[slot + 5u] = extent.y;
    diptych_reports[record] = key;
    diptych_reports[record + 1u] = found.what;
    diptych_reports[record + 2u] = found.a;
    diptych_reports[record + 3u] = found.b;
    diptych_reports[record + 4u] = found.c;
    diptych_reports[record + 5u] = found.d;
}

/* The findings of shadow.glsl. */
void diptych_finish(const uint key);

void diptych_flush()
{
    uvec3 place = diptych_place(), extent = diptych_extent();
    uint key = ~((place.z * extent.y + place.y) * extent.x + place.x);
    for (int i = 0; i < @free@; i++)
        diptych_lost -= diptych_found[i].times;
    for (int i = 0; i < @rooms@; i++) {
        diptych_found[i].what >>= 5;
        diptych_report(key, diptych_found[i]);
    }
    diptych_finish(key);
}

bool diptych_told(const bool bad, const float a, const float b, const uint site, const uint what)
{
    return diptych_told(bad, floatBitsToUint(a), floatBitsToUint(b), site, what);
}

/* ---- Indices --------------------------------------------------------------------------------- */

/* An index that there is: beyond `shared` memory, CPUs' drivers end. */
uint diptych_index(const uint i, const uint count, const uint site, const uint what)
{
    return mix(i, 0u, diptych_told(i >= count, i, count, site, what));
}

int diptych_index(const int i, const uint count, const uint site, const uint what)
{
    return mix(i, 0, diptych_told(uint(i) >= count, uint(i), count, site, what));
}

/* A mip that there is. */
int diptych_mip(const int i, const uint count, const uint site, const uint what)
{
    return diptych_told(uint(i) >= count, uint(i), count, site, what) ? 0 : i;
}

/* d: width and height in half a word each. */
void diptych_texel(const ivec3 p, const ivec3 size, const uint site, const uint what)
{
    bool fresh = diptych_note(any(greaterThanEqual(uvec3(p), uvec3(size))), site, what);
    diptych_found[what & 31u].a = mix(diptych_found[what & 31u].a, uint(p.x), fresh);
    diptych_found[what & 31u].b = mix(diptych_found[what & 31u].b, uint(p.y), fresh);
    diptych_found[what & 31u].c = mix(diptych_found[what & 31u].c, uint(p.z), fresh);
    diptych_found[what & 31u].d = mix(diptych_found[what & 31u].d, uint(size.x | size.y << 16), fresh);
}

void diptych_texel(const ivec2 p, const ivec2 size, const uint site, const uint what)
{
    diptych_texel(ivec3(p, 0), ivec3(size, 1), site, what);
}

void diptych_texel(const int p, const int size, const uint site, const uint what)
{
    diptych_texel(ivec3(p, 0, 0), ivec3(size, 1, 1), site, what);
}

/* ---- Integers -------------------------------------------------------------------------------- */

/* A check of one or two operands of type T, x and y, which the message has. */
#define DIPTYCH_INTEGERS(check, T, wrong) \
bool diptych_##check(const T x, const T y, const uint site, const uint what) \
{ \
    return diptych_told(wrong, uint(x), uint(y), site, what); \
}
#define DIPTYCH_INTEGER(check, T, wrong) \
bool diptych_##check(const T x, const uint site, const uint what) { return diptych_told(wrong, uint(x), 0u, site, what); }

DIPTYCH_INTEGERS(divide, int, any(bvec2(y == 0, all(bvec2(y == -1, uint(x) == 0x80000000u)))))
DIPTYCH_INTEGERS(divide, uint, y == 0u)
DIPTYCH_INTEGERS(modulo, int, any(bvec2(y <= 0, x < 0)))
DIPTYCH_INTEGERS(modulo, uint, y == 0u)
DIPTYCH_INTEGERS(bits, int, any(bvec3(x < 0, y < 0, y > 32 - x))) /* offset and count */
DIPTYCH_INTEGERS(clamp, int, x > y)
DIPTYCH_INTEGERS(clamp, uint, x > y)
DIPTYCH_INTEGER(shift, uint, x >= 32u)
DIPTYCH_INTEGER(shift, int, uint(x) >= 32u)

/* What is computed with instead, where the check finds a fault: CPUs end a program that divides by zero, or INT_MIN by -1. */
int diptych_safe_divide(const int a, const int b)
{
    return mix(b, 1, any(bvec2(b == 0, all(bvec2(b == -1, uint(a) == 0x80000000u)))));
}

uint diptych_safe_divide(const uint a, const uint b)
{
    return max(b, 1u);
}

int diptych_safe_modulo(const int a, const int b)
{
    return diptych_safe_divide(a, b);
}

uint diptych_safe_modulo(const uint a, const uint b)
{
    return max(b, 1u);
}

int diptych_safe_shift(const int count)
{
    return count & 31;
}

uint diptych_safe_shift(const uint count)
{
    return count & 31u;
}

/* ---- Floats ---------------------------------------------------------------------------------- */

bool diptych_finite(const float x)
{
    return (floatBitsToUint(x) & 0x7f800000u) != 0x7f800000u;
}

#define DIPTYCH_VECTOR(T, U) \
bool diptych_finite(const T x) { return all(lessThan(floatBitsToUint(x) & 0x7f800000u, U(0x7f800000u))); }

DIPTYCH_VECTOR(vec2, uvec2)
DIPTYCH_VECTOR(vec3, uvec3)
DIPTYCH_VECTOR(vec4, uvec4)

bool diptych_nan(const float x)
{
    return (floatBitsToUint(x) & 0x7fffffffu) > 0x7f800000u;
}

/* Results of an operation, and whether its operands are finite and in its domain. */
void diptych_made(const float result, const bool finite, const uint site, const uint what)
{
    diptych_told(all(bvec2(finite, !diptych_finite(result))), result, 0.0, site, what);
}

void diptych_made(const vec2 result, const bool finite, const uint site, const uint what)
{
    diptych_made(mix(result.x, result.y, diptych_finite(result.x)), finite, site, what);
}

void diptych_made(const vec3 result, const bool finite, const uint site, const uint what)
{
    diptych_made(mix(result.x, mix(result.y, result.z, diptych_finite(result.y)), diptych_finite(result.x)), finite, site, what);
}

void diptych_made(const vec4 result, const bool finite, const uint site, const uint what)
{
    diptych_made(mix(result.xy, result.zw, bvec2(diptych_finite(result.xy))), finite, site, what);
}

#define DIPTYCH_FLOAT(check, wrong) \
bool diptych_##check(const float x, const uint site, const uint what) { return diptych_told(wrong, x, 0.0, site, what); }
#define DIPTYCH_FLOATS(check, wrong) \
bool diptych_##check(const float x, const float y, const uint site, const uint what) { return diptych_told(wrong, x, y, site, what); }

DIPTYCH_FLOAT(to_int, !all(bvec2(x >= -2147483648.0, x < 2147483648.0)))
DIPTYCH_FLOAT(to_uint, !all(bvec2(x >= 0.0, x < 4294967296.0)))
DIPTYCH_FLOAT(sqrt, x < 0.0)
DIPTYCH_FLOAT(positive, x <= 0.0)
DIPTYCH_FLOAT(unit, abs(x) > 1.0)
DIPTYCH_FLOAT(acosh, x < 1.0)
DIPTYCH_FLOAT(atanh, abs(x) >= 1.0)
DIPTYCH_FLOAT(half, all(bvec2(abs(x) >= 65520.0, diptych_finite(x)))) /* finite numbers that are infinite as halves */
DIPTYCH_FLOAT(frexp, !diptych_finite(x))
DIPTYCH_FLOATS(pow, any(bvec2(x < 0.0, all(bvec2(x == 0.0, y <= 0.0)))))
DIPTYCH_FLOATS(atan, vec2(y, x) == vec2(0.0))
DIPTYCH_FLOATS(smoothstep, x >= y)
DIPTYCH_FLOATS(clamp, x > y)

/* A check whose message has no operand. */
#define DIPTYCH_UNTOLD(check, T, wrong) \
bool diptych_##check(const T x, const uint site, const uint what) { return diptych_told(wrong, 0u, 0u, site, what); }

DIPTYCH_UNTOLD(packed, float, diptych_nan(x))
DIPTYCH_UNTOLD(normalize, float, x == 0.0)
DIPTYCH_UNTOLD(normalize, vec2, x == vec2(0.0))
DIPTYCH_UNTOLD(normalize, vec3, x == vec3(0.0))
DIPTYCH_UNTOLD(normalize, vec4, x == vec4(0.0))

bool diptych_mix(const float x, const float y, const float a, const uint site, const uint what)
{
    return diptych_told(any(bvec3(diptych_nan(x), diptych_nan(y), diptych_nan(a))), 0u, 0u, site, what);
}

/* A NaN goes into a function that gives another number instead. */
bool diptych_dropped(const float x, const float y, const uint site, const uint what)
{
    return diptych_told(any(bvec2(diptych_nan(x), diptych_nan(y))), mix(y, x, diptych_nan(x)), 0.0, site, what);
}

bool diptych_dropped(const float x, const float low, const float high, const uint site, const uint what)
{
    return diptych_dropped(x, mix(low, high, diptych_nan(high)), site, what);
}

/* ---- Variables ------------------------------------------------------------------------------- */

/* Bits of the components that have values, and of those that are read. */
void diptych_assigned(const uint bits, const uint wanted, const uint site, const uint what)
{
    diptych_note((bits & wanted) != wanted, site, what);
}

/* All bits where there are none. */
uint diptych_none(const uint bits)
{
    return mix(0u, 0xffffffffu, bits == 0u);
}

/* What four bits lack, between the stages, and back: interpolated, it is above 0 where one of the vertices lacks it. */
vec4 diptych_given(const uint bits)
{
    return vec4(~(uvec4(bits) >> uvec4(0u, 1u, 2u, 3u)) & 1u);
}

uint diptych_taken(const vec4 missing)
{
    uvec4 bits = uvec4(lessThanEqual(missing, vec4(0.0))) << uvec4(0u, 1u, 2u, 3u);
    return bits.x | bits.y | bits.z | bits.w;
}

/* ---- Loops ----------------------------------------------------------------------------------- */

/* Turns of all loops of the invocation. */
uint diptych_turns = 0u;

/* Whether the loop, which begins a turn, has run for long enough to be ended. Mesa 22's llvmpipe silently ends loops after
 * 65,535 turns, summed over all loops of a shader; so 65,000 are told. If the limit is a constant, Mesa 25 unrolls the loop
 * turn by turn, which takes minutes; so it is compared with the frame's number, too, which is less. */
bool diptych_turn(const uint turns, const uint site, const uint what)
{
    diptych_turns++;
    diptych_told(diptych_turns == 65000u, turns, 0u, site, what);
    return turns > max(1048576u, diptych_now());
}
