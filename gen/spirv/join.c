/* Two modules become one: a whole shader, and what the generator wrote beside it. The shader keeps its entry
 * point, its numbers and its order; the other module's functions, resources and constants follow, and its
 * main(), which gives its global variables their first values, as diptych_globals() (entry.c). Built-in variables
 * that both have become one. */
#include <spirv/unified1/spirv.h>
#include <string.h>

#include "link.h"
#include "passes.h"

struct joining {
    const struct spirv *own, *more;
    struct spirv_edit edit;
    struct spirv_link link;
};

/* ---- Ids ------------------------------------------------------------------------------------- */

/* The built-in of a variable, or of the members of its block one after the other; 0: none. */
static uint64_t built_ins(const struct spirv *module, const uint32_t *variable)
{
    uint32_t own = spirv_decoration(module, variable[2], SpvDecorationBuiltIn);
    uint32_t type = spirv_definition(module, variable[1])[3];
    const uint32_t *block = spirv_definition(module, type);
    uint64_t all = own == UINT32_MAX ? 0 : own + 1;
    for (uint32_t m = 0; spirv_is(block, SpvOpTypeStruct) && m + 2 < spirv_length(block); m++) {
        uint32_t member = spirv_member_decoration(module, type, m, SpvDecorationBuiltIn);
        if (member == UINT32_MAX)
            return 0; /* a block has them in all of its members */
        all = all * 8191 + member + 1;
    }
    return all;
}

/* The shader's variable of the same built-ins, in the same direction; NULL: none. */
static const uint32_t *find_built_in(const struct spirv *own, uint64_t built_in, uint32_t class)
{
    SPIRV_EACH(own, i, own->declarations, own->code)
        if (spirv_is(i, SpvOpVariable) && i[3] == class && built_ins(own, i) == built_in)
            return i;
    return NULL;
}

static void share_built_ins(struct joining *j)
{
    const struct spirv *more = j->more;
    SPIRV_EACH(more, i, more->declarations, more->code) {
        uint64_t built_in = spirv_is(i, SpvOpVariable) ? built_ins(more, i) : 0;
        const uint32_t *own = built_in ? find_built_in(j->own, built_in, i[3]) : NULL;
        if (!own)
            continue;
        j->link.ids[i[2]] = own[2];
        if (spirv_is(spirv_definition(more, spirv_definition(more, i[1])[3]), SpvOpTypeStruct))
            j->link.ids[spirv_definition(more, i[1])[3]] = spirv_definition(j->own, own[1])[3];
    }
}

/* ---- Sections -------------------------------------------------------------------------------- */

/* The instruction of the shader that says the same; NULL: none. */
static const uint32_t *find_same(const struct spirv *own, const uint32_t *i)
{
    uint32_t from = spirv_is(i, SpvOpExtInstImport) ? 2 : 1;
    SPIRV_EACH(own, same, SPIRV_HEADER, own->annotations)
        if (*same == *i && !memcmp(same + from, i + from, (spirv_length(i) - from) * sizeof *i))
            return same;
    return NULL;
}

/* The shader's entry point lists the other module's variables, too. */
static void add_interface(struct joining *j)
{
    const uint32_t *more = spirv_entry_point(j->more), *own = spirv_entry_point(j->own);
    for (uint32_t word = spirv_entry_variables(more); word < spirv_length(more); word++) {
        uint32_t id = spirv_link_id(&j->link, more[word]);
        bool there = false;
        for (uint32_t k = spirv_entry_variables(own); k < spirv_length(own); k++)
            there |= own[k] == id;
        spirv_edit_list(&j->edit, UINT32_MAX, &id, !there);
    }
}

/* Names that begin so are the generator's: its passes find functions by them. */
static bool is_reserved(const uint32_t *name)
{
    return spirv_is(name, SpvOpName) && !strncmp((const char *)(name + 2), "diptych_", 8);
}

static void join_front(struct joining *j)
{
    struct spirv_words *front = &j->edit.front;
    const struct spirv *own = j->own, *more = j->more;
    front->count = SPIRV_HEADER;
    SPIRV_EACH(own, i, SPIRV_HEADER, own->annotations)
        if (!is_reserved(i))
            spirv_copy(&j->edit, front, i);
    SPIRV_EACH(more, i, SPIRV_HEADER, more->annotations) {
        bool import = spirv_is(i, SpvOpExtInstImport);
        bool demand = spirv_is(i, SpvOpCapability) || spirv_is(i, SpvOpExtension); /* no ids */
        bool name = (spirv_is(i, SpvOpName) || spirv_is(i, SpvOpMemberName)) &&
                    more->definitions[i[1]] && i[1] != spirv_entry(more);
        const uint32_t *same = import || demand ? find_same(own, i) : NULL;
        if (same && import)
            j->link.ids[i[1]] = same[1];
        else if (!same && demand)
            spirv_copy(&j->edit, front, i);
        else if (!same && (import || name || spirv_is(i, SpvOpString)))
            spirv_link_copy(&j->link, front, i);
    }
}

static void join_annotations(struct joining *j)
{
    const struct spirv *own = j->own, *more = j->more;
    spirv_edit_annotations(&j->edit);
    SPIRV_EACH(more, i, more->annotations, more->declarations) {
        bool size = spirv_is(i, SpvOpDecorate) && i[2] == SpvDecorationBuiltIn &&
                    i[3] == SpvBuiltInWorkgroupSize; /* a constant; the shader has its own */
        if (!size && spirv_link_id(&j->link, i[1]) >= own->words[3])
            spirv_link_copy(&j->link, &j->edit.annotations, i);
    }
}

/* A load; of a built-in that the shader declares with the other sign, as HLSL does, converted. */
static void join_load(struct joining *j, const uint32_t *load)
{
    uint32_t variable = spirv_link_id(&j->link, load[3]), type = spirv_link_id(&j->link, load[1]),
             own = type;
    if (variable < j->own->words[3] && spirv_is(spirv_definition(j->own, variable), SpvOpVariable))
        own = spirv_definition(j->own, spirv_definition(j->own, variable)[1])[3];
    if (own == type) {
        spirv_link_copy(&j->link, &j->edit.code, load);
        return;
    }
    uint32_t value = SPIRV_VALUE(&j->edit, &j->edit.code, SpvOpLoad, own, variable);
    SPIRV_PUT(&j->edit, &j->edit.code, SpvOpBitcast, type, spirv_link_id(&j->link, load[2]), value);
}

static void join_code(struct joining *j)
{
    const struct spirv *own = j->own, *more = j->more;
    spirv_append(&j->edit, &j->edit.code, own->words + own->code, own->count - own->code);
    SPIRV_EACH(more, i, more->code, more->count)
        if (spirv_is(i, SpvOpLoad))
            join_load(j, i);
        else
            spirv_link_copy(&j->link, &j->edit.code, i);
    spirv_put_name(&j->edit, spirv_link_id(&j->link, spirv_entry(more)), "diptych_globals(");
}

bool spirv_join(struct spirv *module, const struct spirv *more)
{
    struct joining j = {.own = module, .more = more};
    spirv_edit_begin(&j.edit, module);
    j.link =
        (struct spirv_link){.edit = &j.edit,
                            .more = more,
                            .ids = spirv_edit_alloc(&j.edit, more->words[3], sizeof *j.link.ids)};
    if (!j.edit.failed) {
        share_built_ins(&j);
        SPIRV_EACH(more, i, more->declarations, more->code)
            if (spirv_result(i))
                spirv_link_id(&j.link, spirv_result(i));
        join_annotations(&j);
        join_front(&j);
        add_interface(&j);
        join_code(&j);
        if (!j.edit.failed && more->words[1] > module->words[1])
            j.edit.front.data[1] = more->words[1];
    }
    return spirv_edit_end(&j.edit, module);
}
