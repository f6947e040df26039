/* --sanitize=race and flow: before an operation on memory that the dispatch also stores to, its cell learns which invocation
 * touches it; before a barrier, the workgroup learns which barrier comes. See templates/glsl/cells.glsl. */
#include <spirv/unified1/spirv.h>
#include <stdio.h>

#include "sanitizer.h"

/* words: from `at` on. */
static void put_access(struct sanitizer *s, const struct memory *memory, uint32_t at,
                       uint32_t words, uint32_t site)
{
    uint32_t cell = at ? memory_cell(s, memory, at) : 0;
    struct values values = {{cell, at, sanitizer_number(s, words)}, 3};
    if (!cell)
        return;
    if (site) {
        sanitizer_place(s, &values, site);
        sanitizer_call(s, "diptych_stores(u1;u1;u1;u1;u1;", &values);
    } else {
        sanitizer_call(s, "diptych_loads(u1;u1;u1;", &values);
    }
}

/* Whether the dispatch stores to it: else its loads meet no store. */
static bool is_stored(const struct sanitizer *s, const struct memory *memory)
{
    char name[40] = "diptych_shared_cell(u1;u1;";
    if (memory->access)
        snprintf(name, sizeof name, "diptych_cell_%d(u1;", memory->access->binding);
    return memory->variable && sanitizer_has(s, name);
}

static uint32_t add_site(struct sanitizer *s, const struct memory *memory)
{
    struct sanitize_site site = {.pairs = true};
    memory_name(s, memory, &site);
    snprintf(site.text, sizeof site.text,
             "@2e is also touched by invocation @1p, and no barrier is between");
    s->kind = SANITIZE_RACE;
    return sanitizer_add(s, &site);
}

static void put_race(struct sanitizer *s, const uint32_t *i)
{
    struct texel_use use;
    uint32_t stored = memory_stored(s, i);
    bool stores = stored || spirv_is(i, SpvOpImageWrite), writes;
    bool atomic = memory_is_atomic(i, &writes);
    if (!stores && !atomic && !spirv_is(i, SpvOpLoad) && !spirv_is(i, SpvOpImageRead))
        return;
    uint32_t pointer = stored ? stored : stores ? i[1] : i[3];
    struct memory memory = memory_of(s, pointer);
    bool texel = memory_image(atomic ? spirv_definition(s->from, pointer) : i, &use);
    if (!is_stored(s, &memory) ||
        (memory.access && memory.access->resource->kind == DT_IMAGE && !texel))
        return;
    uint32_t site = stores ? add_site(s, &memory) : 0;
    if (texel) {
        put_access(s, &memory, memory_texel(s, &memory, use.place, use.lod), 1, site);
        return;
    }
    uint32_t pointee = spirv_pointee(s->from, spirv_definition(s->from, pointer));
    const uint32_t *number = spirv_scalar(s->from, spirv_definition(s->from, pointee));
    bool part = spirv_is(number, SpvOpTypeInt) || spirv_is(number, SpvOpTypeFloat);
    if (memory.access && part && number[2] < 32)
        return; /* a cell is of a word, of which others may store the rest */
    uint32_t words, word = memory_range(s, &memory, pointer, &words);
    put_access(s, &memory, memory.access ? memory_at(s, &memory, word) : word, words, site);
}

bool race_is_barrier(const struct spirv *from, const uint32_t *i)
{
    const uint32_t *scope = spirv_is(i, SpvOpControlBarrier) ? spirv_definition(from, i[1]) : NULL;
    return scope && !(spirv_is(scope, SpvOpConstant) && scope[3] == SpvScopeSubgroup);
}

static void put_barrier(struct sanitizer *s, size_t place)
{
    struct values none = {.count = 0};
    if (!(s->request->kinds & SANITIZE_FLOW)) {
        sanitizer_call(s, "diptych_passes_barrier(", &none);
        return;
    }
    s->kind = SANITIZE_FLOW;
    uint32_t site = sanitizer_site(s, "barrier", "",
                                   "some invocations of the workgroup do not reach this barrier");
    struct values values = {{sanitizer_number(s, site), quads_path(s, place)}, 2};
    sanitizer_call(s, "diptych_arrives(u1;u1;", &values);
}

void race_before(struct sanitizer *s, size_t place)
{
    unsigned kinds = s->request->kinds;
    const uint32_t *i = s->from->words + place;
    if (race_is_barrier(s->from, i) && kinds & (SANITIZE_RACE | SANITIZE_FLOW))
        put_barrier(s, place);
    else if (kinds & SANITIZE_RACE)
        put_race(s, i);
}
