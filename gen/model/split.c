/* Textures that are members of structs of uniforms, which Vulkan does not have (glsl_compile_whole() leaves them there), become variables
 * with joined names: material.diffuse is material_diffuse, lights[1].map lights_1_map. Where an index of an array of structs is no
 * constant, the textures of all become one array, lights_map, which spread.c parts. All other uniforms then become of the class of
 * blocks. */
#include <spirv/unified1/spirv.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "foreign.h"
#include "leaves.h"

enum { NAME_SIZE = 256, FIRST_BINDING = 1000 };

struct split_texture {
    uint32_t id; /* new variable */
    char name[NAME_SIZE];
};

struct splitting {
    const struct spirv *from;
    struct spirv_edit edit;
    bool arrays;     /* a struct of an array is chosen by no constant */
    uint32_t *known; /* by id of a chain: the variable that it leads to */
    struct split_texture *textures;
    uint32_t count;
};

/* The image of a texture or of an array of them; NULL: of another type. */
static const uint32_t *texture_of(const struct spirv *from, uint32_t type)
{
    const uint32_t *inner = spirv_definition(from, spirv_element_type(from, type));
    inner = spirv_is(inner, SpvOpTypeSampledImage) ? spirv_definition(from, inner[2]) : inner;
    return spirv_is(inner, SpvOpTypeImage) ? inner : NULL;
}

/* The variable of structs with textures that a chain begins at; NULL: it begins at another. */
static const uint32_t *split_variable(const struct spirv *from, const uint32_t *chain)
{
    const uint32_t *variable =
        spirv_is(chain, SpvOpAccessChain) ? spirv_definition(from, chain[3]) : chain;
    if (!spirv_is(variable, SpvOpVariable) || variable[3] != SpvStorageClassUniformConstant)
        return NULL;
    uint32_t element = spirv_element_type(from, spirv_pointee(from, variable));
    return spirv_is(spirv_definition(from, element), SpvOpTypeStruct) ? variable : NULL;
}

/* How many words of a chain into the block lead to a texture or an array of them, and its name and type; 0: to a number, or by
 * indices that are no constants. around: the array of structs that it is in, and its index; 0: it is a texture of its own. */
static uint32_t lead(const struct splitting *s, const uint32_t *chain, char name[NAME_SIZE],
                     uint32_t *type, uint32_t around[2])
{
    const struct spirv *from = s->from;
    size_t length = 0;
    const char *own = spirv_variable_name(from, split_variable(from, chain));
    *type = spirv_pointee(from, split_variable(from, chain));
    around[0] = 0;
    length = (size_t)snprintf(name, NAME_SIZE, "%.60s", own);
    for (uint32_t word = 4; word < spirv_length(chain); word++) {
        const uint32_t *outer = spirv_definition(from, *type);
        const uint32_t *index = spirv_definition(from, chain[word]);
        const char *member = NULL;
        bool chosen = s->arrays && spirv_is_array(outer);
        if ((chosen ? around[0] : !spirv_is(index, SpvOpConstant)) || length > NAME_SIZE - 64)
            return 0;
        if (chosen) {
            around[0] = *type, around[1] = chain[word], *type = outer[2];
            continue;
        }
        if (spirv_is(outer, SpvOpTypeStruct))
            member = spirv_member_name(from, *type, index[3]);
        length += (size_t)(member ? snprintf(name + length, NAME_SIZE - length, "%s%.60s",
                                             length ? "_" : "", member)
                                  : snprintf(name + length, NAME_SIZE - length, "_%u", index[3]));
        *type = outer[member ? 2 + index[3] : 2];
        if (texture_of(from, *type))
            return around[0] && spirv_is_array(spirv_definition(from, *type)) ? 0 : word + 1;
    }
    return 0;
}

/* The variable of that name, which is new if none has it; 0: out of memory. */
static uint32_t variable_of(struct splitting *s, const char *name, uint32_t type)
{
    struct spirv_edit *edit = &s->edit;
    for (uint32_t i = 0; i < s->count; i++)
        if (!strcmp(s->textures[i].name, name))
            return s->textures[i].id;
    struct split_texture *more = realloc(s->textures, (s->count + 1) * sizeof *more);
    edit->failed |= !more;
    if (!more)
        return 0;
    s->textures = more;
    uint32_t id = spirv_add_variable(edit, SpvStorageClassUniformConstant, type);
    more[s->count].id = id;
    snprintf(more[s->count].name, NAME_SIZE, "%s", name);
    SPIRV_PUT(edit, &edit->annotations, SpvOpDecorate, id, SpvDecorationDescriptorSet, 0);
    SPIRV_PUT(edit, &edit->annotations, SpvOpDecorate, id, SpvDecorationBinding,
              FIRST_BINDING + s->count);
    s->count++;
    spirv_put_name(edit, id, name);
    return id;
}

/* Numbers are in a class that holds them, and members that are textures become numbers. */
static void change_types(struct splitting *s)
{
    struct spirv_words *own = &s->edit.declarations;
    for (size_t at = 0; !s->edit.failed && at < own->count; at += spirv_length(own->data + at)) {
        uint32_t *i = own->data + at;
        bool pointer = spirv_is(i, SpvOpTypePointer) && i[1] < s->from->words[3];
        bool variable = spirv_is(i, SpvOpVariable) && i[2] < s->from->words[3];
        uint32_t held = pointer ? i[3] : variable ? spirv_pointee(s->from, i) : 0;
        uint32_t *class = i + (pointer ? 2 : 3);
        if (held && *class == SpvStorageClassUniformConstant && !texture_of(s->from, held))
            *class = SpvStorageClassUniform;
        for (uint32_t word = 2; spirv_is(i, SpvOpTypeStruct) && word < spirv_length(i); word++) {
            const uint32_t *image = texture_of(s->from, i[word]);
            i[word] = image ? image[2] : i[word];
        }
    }
}

static void put_split(struct splitting *s)
{
    const struct spirv *from = s->from;
    struct spirv_edit *edit = &s->edit;
    SPIRV_EACH(from, i, from->code, from->count) {
        bool chain = spirv_is(i, SpvOpAccessChain) && split_variable(from, i);
        char name[NAME_SIZE];
        uint32_t type, around[2], words = chain ? lead(s, i, name, &type, around) : 0;
        if (words && around[0])
            type =
                SPIRV_DECLARE(edit, SpvOpTypeArray, 0, type, spirv_definition(from, around[0])[3]);
        uint32_t variable = words ? variable_of(s, name, type) : 0;
        if (variable && around[0]) {
            SPIRV_PUT(edit, &edit->code, SpvOpAccessChain, i[1], i[2], variable, around[1]);
            continue;
        }
        if (variable && words == spirv_length(i)) {
            s->known[i[2]] = variable;
            continue;
        }
        if (variable) { /* of an element */
            uint32_t head[] = {*i - ((words - 4) << 16), i[1], i[2], variable};
            spirv_append(edit, &edit->code, head, 4);
            spirv_append(edit, &edit->code, i + words, spirv_length(i) - words);
            continue;
        }
        spirv_copy_mapped(edit, &edit->code, i, s->known);
    }
}

/* Whether all chains to textures can be had; a module where one cannot is refused when it is bound. */
static bool can_split(const struct splitting *s)
{
    const struct spirv *from = s->from;
    SPIRV_EACH(from, i, from->code, from->count) {
        char name[NAME_SIZE];
        uint32_t type, around[2];
        bool chain = spirv_is(i, SpvOpAccessChain) && split_variable(from, i);
        if (chain && texture_of(from, spirv_pointee(from, i)) && !lead(s, i, name, &type, around))
            return false;
    }
    return true;
}

bool spirv_split(struct spirv *module)
{
    struct splitting s = {.from = module};
    bool found = false;
    SPIRV_EACH(module, i, module->declarations, module->code)
        found |= split_variable(module, i) != NULL;
    s.arrays = found && !can_split(&s);
    if (!found || (s.arrays && !can_split(&s)))
        return true;
    spirv_edit_begin(&s.edit, module);
    s.known = spirv_edit_table(&s.edit, sizeof *s.known);
    if (!s.edit.failed) {
        spirv_edit_annotations(&s.edit);
        put_split(&s);
        change_types(&s);
    }
    free(s.textures);
    return spirv_edit_end(&s.edit, module);
}
