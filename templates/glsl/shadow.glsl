/* Shadow memory of --sanitize=content,race,flow. gen/plan/shadow.c appends this file to sanitize.glsl, with the functions of each
 * binding: diptych_at_B() is the index of a texel or of a word of a buffer in its resource, or none; gen/spirv/content.c and
 * gen/spirv/race.c call them.
 *
 * A mark says that a value comes from memory that nothing has written: the number of the read in 10 bits, and above them the
 * texel or word. 0: it has been written. Values carry marks to where they are used. */
const uint diptych_none_at = 0xffffffffu;

/* Per texel or word: the frame that wrote it last, + 1. */
layout(std430, @shadow@) coherent buffer Diptych_shadow {
    uint diptych_shadow[];
};

uint diptych_word_at(const uint word, const uint words)
{
    return mix(diptych_none_at, word, word < words);
}

/* Mips follow each other, each with its layers. */
uint diptych_texel_at(const ivec3 p, const int mip, const int mips, const ivec3 whole, const bool solid)
{
    ivec3 size = whole;
    uint first = 0u;
    for (int k = 0; k < min(mip, mips); k++) {
        first += uint(size.x * size.y * size.z);
        size = max(ivec3(size.xy >> 1, size.z >> int(solid)), ivec3(1));
    }
    bool outside = any(bvec2(any(greaterThanEqual(uvec3(p), uvec3(size))), uint(mip) >= uint(mips)));
    return mix(first + uint((p.z * size.y + p.y) * size.x + p.x), diptych_none_at, outside);
}

/* ---- Content --------------------------------------------------------------------------------- */

uint diptych_mark(const uint at, const uint number)
{
    return min(at, 0x3fffffu) << 10 | number;
}

/* base: of the resource in the shadow. whole: something has written all of it. ever: in any frame. */
uint diptych_unwritten(const uint at, const uint base, const bool whole, const bool ever, const uint number)
{
    bool beside = any(bvec2(whole, at == diptych_none_at));
    uint written = diptych_shadow[mix(base + at, 0u, beside)];
    bool good = any(bvec3(beside, written == diptych_now(), all(bvec2(ever, written != 0u))));
    return mix(diptych_mark(at, number), 0u, good);
}

void diptych_written(const uint at, const uint base)
{
    if (at != diptych_none_at)
        diptych_shadow[base + at] = diptych_now();
}

/* The first mark that the invocation has used, and how often those of its read. */
uint diptych_marked = 0u, diptych_marks = 0u;

void diptych_use(const uint mark)
{
    diptych_marked = mix(diptych_marked, mark, diptych_marked == 0u);
    diptych_marks += uint(all(bvec2(mark != 0u, (mark & 1023u) == (diptych_marked & 1023u))));
}

/* The value that a generated function returns has the number of the author's call. */
uint diptych_renumber(const uint mark, const uint number)
{
    return mix((mark & 0xfffffc00u) | number, 0u, mark == 0u);
}

/* The site of a read: gen/spirv/content.c writes this function. */
uint diptych_number(const uint number)
{
    return number;
}

void diptych_finish_content(const uint key)
{
    uint what = diptych_number(diptych_marked & 1023u), site = mix(what + 1u, 0u, diptych_marked == 0u);
    diptych_report(key, Diptych_found(site, what, diptych_marks, diptych_marked >> 10, 0u, 0u, diptych_frame_size()));
}
