/* The stages of a draw as one program: what a fragment shader reads is what its vertex shader writes. Variables
 * without a location match by name, as OpenGL 4.6, 7.4.1, has it, blocks by the name of the block; then both
 * get the same location, in the order in which the vertex shader declares them. Others match by location. */
#include <spirv/unified1/spirv.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "model/leaves.h"
#include "stages.h"

enum { NOWHERE = -1, MOST_LOCATIONS = 1024 };

struct between {              /* a variable between two stages */
    uint32_t id, type, block; /* block: 0: none */
    const char *name;         /* of a block, the block's; NULL: none */
    int location;             /* NOWHERE: none yet */
    int count;                /* of locations */
    uint32_t component;
    bool given, used;
};

struct side {
    const struct spirv *module;
    struct between *list; /* free() */
    uint32_t count;
};

/* ---- One side -------------------------------------------------------------------------------- */

/* The struct of a variable, below the layers of arrays; 0: it is no block. */
static uint32_t block_of(const struct spirv *module, uint32_t type)
{
    while (spirv_is(spirv_definition(module, type), SpvOpTypeArray))
        type = spirv_definition(module, type)[2];
    bool block = spirv_is(spirv_definition(module, type), SpvOpTypeStruct) &&
                 spirv_decoration(module, type, SpvDecorationBlock) != UINT32_MAX;
    return block ? type : 0;
}

static bool is_built_in(const struct spirv *module, uint32_t id, uint32_t block)
{
    return spirv_decoration(module, id, SpvDecorationBuiltIn) != UINT32_MAX ||
           (block && spirv_member_decoration(module, block, 0, SpvDecorationBuiltIn) != UINT32_MAX);
}

static void add_between(struct side *side, const uint32_t *variable)
{
    const struct spirv *module = side->module;
    uint32_t id = variable[2], type = spirv_definition(module, variable[1])[3];
    uint32_t block = block_of(module, type);
    if (is_built_in(module, id, block))
        return;
    uint32_t location = spirv_decoration(module, id, SpvDecorationLocation);
    uint64_t locations = spirv_locations(module, type);
    if (block && location == UINT32_MAX)
        location = spirv_member_decoration(module, block, 0, SpvDecorationLocation);
    side->list[side->count++] =
        (struct between){.id = id,
                         .type = type,
                         .block = block,
                         .name = spirv_name(module, block ? block : id),
                         .location = location < MOST_LOCATIONS ? (int)location : NOWHERE,
                         .count = locations < MOST_LOCATIONS ? (int)locations : MOST_LOCATIONS,
                         .component = spirv_decoration(module, id, SpvDecorationComponent),
                         .given = location != UINT32_MAX,
                         .used = spirv_mentions(module, NULL, id)};
}

/* Gives locations to those that have none: the first free ones, in order. */
static void locate(struct side *side)
{
    CHANGE_EACH(own, side->list, side->count) {
        int location = own->location == NOWHERE ? 0 : own->location;
        for (uint32_t k = 0; k < side->count && own->location == NOWHERE; k++) {
            const struct between *other = &side->list[k];
            if (other->location == NOWHERE || other->location >= location + own->count ||
                location >= other->location + other->count)
                continue;
            location = other->location + other->count;
            k = UINT32_MAX; /* from the first again */
        }
        own->location = location;
    }
}

/* False: out of memory. */
static bool read_side(struct side *side, const struct spirv *module, uint32_t class)
{
    *side = (struct side){.module = module, .list = calloc(module->words[3], sizeof *side->list)};
    SPIRV_EACH(module, i, module->declarations, side->list ? module->code : module->declarations)
        if (spirv_is(i, SpvOpVariable) && i[3] == class)
            add_between(side, i);
    return side->list;
}

/* ---- Both ------------------------------------------------------------------------------------ */

__attribute__((format(printf, 3, 4))) static bool
set_fault(struct stage_fault *fault, const char *name, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(fault->text, sizeof fault->text, format, arguments);
    va_end(arguments);
    snprintf(fault->name, sizeof fault->name, "%s", name ? name : "");
    return false;
}

static bool same_name(const char *a, const char *b)
{
    return !a || !b || !strcmp(a, b);
}

/* Whether two types are the same. given: they match by location, and members may have other names. */
static bool types_match(const struct spirv *from, uint32_t a, const struct spirv *to, uint32_t b,
                        bool given)
{
    const uint32_t *x = spirv_definition(from, a), *y = spirv_definition(to, b);
    uint32_t parts = spirv_parts(from, x);
    if (spirv_opcode(x) != spirv_opcode(y) || parts != spirv_parts(to, y))
        return false;
    if (!parts)
        return spirv_length(x) == spirv_length(y) &&
               !memcmp(x + 2, y + 2, (spirv_length(x) - 2) * sizeof *x);
    if (!spirv_is(x, SpvOpTypeStruct))
        return types_match(from, x[2], to, y[2], given);
    for (uint32_t m = 0; m < parts; m++)
        if (!types_match(from, x[2 + m], to, y[2 + m], given) ||
            !(given || same_name(spirv_member_name(from, a, m), spirv_member_name(to, b, m))))
            return false;
    return true;
}

/* Whether the first is a longer vector. */
static bool is_wider(const struct spirv *from, uint32_t a, const struct spirv *to, uint32_t b)
{
    const uint32_t *x = spirv_definition(from, a), *y = spirv_definition(to, b);
    bool vector = spirv_is(y, SpvOpTypeVector);
    return spirv_is(x, SpvOpTypeVector) &&
           spirv_parts(from, x) > (vector ? spirv_parts(to, y) : 1) &&
           types_match(from, x[2], to, vector ? y[2] : b, true);
}

/* Whether it, or a member of its block, has the decoration. */
static bool says(const struct side *side, const struct between *own, uint32_t what)
{
    const uint32_t *block = own->block ? spirv_definition(side->module, own->block) : NULL;
    bool found = spirv_decoration(side->module, own->id, what) != UINT32_MAX;
    for (uint32_t m = 0; block && m < spirv_parts(side->module, block); m++)
        found |= spirv_member_decoration(side->module, own->block, m, what) != UINT32_MAX;
    return found;
}

/* The first number of a type is whole: a fragment shader reads it flat, however it was written. */
static bool is_whole(const struct spirv *module, uint32_t type)
{
    const uint32_t *own = spirv_definition(module, type);
    while (spirv_parts(module, own))
        own = spirv_definition(module, spirv_part(own, 0));
    return spirv_is(own, SpvOpTypeInt);
}

/* Whether both are interpolated alike, which OpenGL demands before GLSL 4.40. */
static bool check_interpolation(const struct side *reader, const struct between *input,
                                const struct side *writer, const struct between *output,
                                struct stage_fault *fault)
{
    for (uint32_t what = SpvDecorationNoPerspective; what <= SpvDecorationFlat; what++) {
        bool flat = what == SpvDecorationFlat, reads = says(reader, input, what);
        if (reads != says(writer, output, what) && !(flat && is_whole(reader->module, input->type)))
            return set_fault(fault, input->name,
                             "the %s stage alone has `%s` %s: before GLSL 4.40 both say the same",
                             reads ? "fragment" : "vertex", input->name,
                             flat ? "flat" : "noperspective");
    }
    return true;
}

/* By location, else by name. Of several at one location that with the same first component. A location that the
 * vertex shader did not give has the output's name, too. */
static const struct between *find_writer(const struct side *writer, const struct between *input)
{
    const struct between *found = NULL;
    EACH(output, writer->list, writer->count) {
        bool at = input->location >= output->location &&
                  input->location < output->location + output->count &&
                  (output->given || same_name(input->name, output->name));
        bool named = input->name && output->name && !strcmp(input->name, output->name);
        if ((input->given ? at : named) && (!found || output->component == input->component))
            found = output;
    }
    return found;
}

static bool match(struct side *reader, const struct side *writer, unsigned version,
                  struct stage_fault *fault)
{
    CHANGE_EACH(input, reader->list, reader->count) {
        const struct between *output = find_writer(writer, input);
        const char *name = input->name ? input->name : "";
        if (!output && !input->used)
            continue; /* it goes */
        if (!output && input->given)
            return set_fault(
                fault, name,
                "the fragment stage reads location %d, which the vertex stage does not write",
                input->location);
        if (!output)
            return set_fault(fault, name,
                             "the fragment stage reads `%s`, which the vertex stage does not write",
                             name);
        bool whole = !input->given ||
                     (input->location == output->location && input->component == output->component);
        if (whole &&
            !types_match(writer->module, output->type, reader->module, input->type, input->given) &&
            !(input->given && is_wider(writer->module, output->type, reader->module, input->type)))
            return set_fault(
                fault, name,
                "the fragment stage reads `%s` with another type than the vertex stage writes `%s`",
                name, output->name ? output->name : name);
        if (version && version < 440 && !check_interpolation(reader, input, writer, output, fault))
            return false;
        if (!input->given)
            input->location = output->location;
    }
    return true;
}

/* ---- The module ------------------------------------------------------------------------------ */

/* All but inputs that match() left without a location. */
static uint32_t keep_located(const void *user, uint32_t id)
{
    const struct side *side = user;
    for (uint32_t k = 0; k < side->count; k++)
        if (side->list[k].id == id && side->list[k].location == NOWHERE)
            return 0;
    return id;
}

static bool write_side(struct spirv *module, const struct side *side)
{
    struct spirv_edit edit;
    spirv_edit_begin(&edit, module);
    spirv_edit_keep(&edit);
    for (uint32_t i = 0; i < side->count; i++)
        if (!side->list[i].given && side->list[i].location != NOWHERE)
            SPIRV_PUT(&edit, &edit.annotations, SpvOpDecorate, side->list[i].id,
                      SpvDecorationLocation, (uint32_t)side->list[i].location);
    spirv_edit_interface(&edit, keep_located, side);
    return spirv_edit_end(&edit, module);
}

bool spirv_locate(struct spirv *module, uint32_t class)
{
    struct side side;
    bool good = read_side(&side, module, class);
    if (good)
        locate(&side);
    good = good && write_side(module, &side);
    free(side.list);
    return good;
}

bool spirv_locate_inputs(struct spirv *module, const struct spirv *before, unsigned version,
                         struct stage_fault *fault)
{
    struct side reader, writer = {0};
    *fault = (struct stage_fault){0};
    bool good = read_side(&reader, module, SpvStorageClassInput) &&
                read_side(&writer, before, SpvStorageClassOutput);
    if (good) {
        locate(&writer);
        good = match(&reader, &writer, version, fault) && write_side(module, &reader);
    }
    free(reader.list);
    free(writer.list);
    return good;
}
