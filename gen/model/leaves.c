/* See leaves.h. */
#include "leaves.h"

#include <spirv/unified1/spirv.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Names ----------------------------------------------------------------------------------- */

const char *spirv_own_name(const char *name)
{
    return name && !strncmp(name, "body_", 5) ? name + 5 : name;
}

bool spirv_is_array(const uint32_t *type)
{
    return spirv_is(type, SpvOpTypeArray) || spirv_is(type, SpvOpTypeRuntimeArray);
}

uint32_t spirv_element_type(const struct spirv *module, uint32_t type)
{
    while (spirv_is_array(spirv_definition(module, type)))
        type = spirv_definition(module, type)[2];
    return type;
}

const char *spirv_variable_name(const struct spirv *module, const uint32_t *variable)
{
    const char *name = spirv_name(module, variable[2]);
    if (!name || !*name)
        name = spirv_name(module, spirv_element_type(module, spirv_pointee(module, variable)));
    return name ? spirv_own_name(name) : "?";
}

uint32_t spirv_array_length(const struct spirv *module, const uint32_t *type)
{
    const uint32_t *length =
        spirv_is(type, SpvOpTypeArray) ? spirv_definition(module, type[3]) : NULL;
    bool known = length && (spirv_is(length, SpvOpConstant) || spirv_is(length, SpvOpSpecConstant));
    return known ? length[3] : 0;
}

static bool add_lengths(const struct spirv *module, uint32_t type, struct text *out)
{
    const uint32_t *declared = spirv_definition(module, type);
    for (; spirv_is_array(declared); declared = spirv_definition(module, declared[2])) {
        uint32_t length = spirv_array_length(module, declared);
        text_add(out, "[%u]", length);
        if (!length)
            return false;
    }
    return true;
}

/* The letter of the type of a spec that has the numbers of a scalar; 0: none has. */
static char letter_of(const uint32_t *scalar)
{
    if (spirv_is(scalar, SpvOpTypeFloat) || spirv_is(scalar, SpvOpTypeInt))
        return scalar[2] > 32 ? 0 : spirv_is(scalar, SpvOpTypeFloat) ? 'f' : "ui"[scalar[3]];
    return spirv_letter(scalar);
}

bool spirv_type_name(const struct spirv *module, uint32_t type, struct text *out)
{
    static const char letters[] = "fiub", *const scalars[] = {"float", "int", "uint", "bool"},
                      *const vectors[] = {"vec", "ivec", "uvec", "bvec"};
    const uint32_t *element = spirv_definition(module, spirv_element_type(module, type));
    const uint32_t *column =
        spirv_is(element, SpvOpTypeMatrix) ? spirv_definition(module, element[2]) : element;
    const uint32_t *scalar = spirv_scalar(module, column);
    char letter = letter_of(scalar);
    if (!letter)
        return false;
    size_t kind = (size_t)(strchr(letters, letter) - letters);
    if (column != element && column[3] == element[3])
        text_add(out, "mat%u", element[3]);
    else if (column != element)
        text_add(out, "mat%ux%u", element[3], column[3]);
    else if (scalar != element)
        text_add(out, "%s%u", vectors[kind], element[3]);
    else
        text_add(out, "%s", scalars[kind]);
    return add_lengths(module, type, out);
}

bool spirv_leaf_type(const struct spirv *module, const struct spirv_leaf *leaf, struct text *out)
{
    bool good = spirv_type_name(module, leaf->types[leaf->depth], out);
    for (uint32_t i = 0; good && i < leaf->depth; i++) {
        const uint32_t *type = spirv_definition(module, leaf->types[i]);
        uint32_t length = spirv_array_length(module, type);
        if (spirv_is_array(type))
            text_add(out, "[%u]", length);
        good = length || !spirv_is_array(type);
    }
    return good;
}

const char *spirv_image_format(uint32_t format)
{
    static const char *const names[] = {/* as SPIR-V numbers them */
                                        "",          "rgba32f",      "rgba16f",
                                        "r32f",      "rgba8",        "rgba8_snorm",
                                        "rg32f",     "rg16f",        "r11f_g11f_b10f",
                                        "r16f",      "rgba16",       "rgb10_a2",
                                        "rg16",      "rg8",          "r16",
                                        "r8",        "rgba16_snorm", "rg16_snorm",
                                        "rg8_snorm", "r16_snorm",    "r8_snorm",
                                        "rgba32i",   "rgba16i",      "rgba8i",
                                        "r32i",      "rg32i",        "rg16i",
                                        "rg8i",      "r16i",         "r8i",
                                        "rgba32ui",  "rgba16ui",     "rgba8ui",
                                        "r32ui",     "rgb10_a2ui",   "rg32ui",
                                        "rg16ui",    "rg8ui",        "r16ui",
                                        "r8ui"};
    return format < sizeof names / sizeof *names ? names[format] : "";
}

void spirv_image_name(const struct spirv *module, const uint32_t *image, bool sampler, char *out,
                      size_t size)
{
    static const char *const shapes[] = {"1D", "2D", "3D", "Cube", "2DRect", "Buffer"};
    const uint32_t *number = spirv_definition(module, image[2]);
    const char *prefix = !spirv_is(number, SpvOpTypeInt) ? "" : number[3] ? "i" : "u";
    snprintf(out, size, "%s%s%s%s%s", prefix, sampler ? "sampler" : "image",
             image[3] < SpvDimSubpassData ? shapes[image[3]] : "", image[6] ? "MS" : "",
             image[5] ? "Array" : "");
}

/* ---- What the entry point reaches ------------------------------------------------------------ */

static void mark_live(const struct spirv *module, uint32_t function, bool *live)
{
    const struct spirv_function *own = spirv_function_of(module, function);
    if (live[own - module->functions])
        return;
    live[own - module->functions] = true;
    SPIRV_EACH(module, i, own->begin, own->end)
        if (spirv_is(i, SpvOpFunctionCall))
            mark_live(module, i[3], live);
}

bool *spirv_live_functions(const struct spirv *module)
{
    bool *live = calloc(module->function_count + 1, sizeof *live);
    if (live)
        mark_live(module, spirv_entry(module), live);
    return live;
}

static bool mentions(const uint32_t *instruction, uint32_t id)
{
    for (uint32_t word = 1; word < spirv_length(instruction); word++)
        if (instruction[word] == id && !spirv_is_literal(instruction, word))
            return true;
    return false;
}

/* Calls `use` for each instruction of a live function that has the id. */
static bool each_use(const struct spirv *module, const bool *live, uint32_t id,
                     void (*use)(void *user, const uint32_t *instruction), void *user)
{
    bool used = false;
    for (uint32_t f = 0; f < module->function_count; f++) {
        if (live && !live[f])
            continue;
        SPIRV_EACH(module, i, module->functions[f].begin, module->functions[f].end) {
            if (!mentions(i, id))
                continue;
            used = true;
            if (use)
                use(user, i);
        }
    }
    return used;
}

bool spirv_mentions(const struct spirv *module, const bool *live, uint32_t id)
{
    return each_use(module, live, id, NULL, NULL);
}

/* ---- Leaves ---------------------------------------------------------------------------------- */

struct walk {
    const struct spirv *module;
    uint32_t most_depth;
    bool *used; /* by leaf, in their order */
    uint32_t next;
    struct spirv_leaf leaf;
    spirv_leaf_taker *take;
    void *user;
};

/* Whether what it holds are leaves, not the type itself. */
static bool has_members(const uint32_t *type)
{
    return spirv_is(type, SpvOpTypeStruct) && spirv_length(type) > 2;
}

/* Up to MOST_LEAVES + 1. */
static uint32_t count_leaves(const struct walk *walk, uint32_t type, uint32_t depth)
{
    const uint32_t *declared = spirv_definition(walk->module, type);
    uint32_t count = 0;
    if (depth < walk->most_depth && spirv_is_array(declared))
        return count_leaves(walk, declared[2], depth + 1);
    if (depth >= walk->most_depth || !has_members(declared))
        return 1;
    for (uint32_t i = 2; i < spirv_length(declared) && count <= MOST_LEAVES; i++)
        count += count_leaves(walk, declared[i], depth + 1);
    return count < MOST_LEAVES ? count : MOST_LEAVES + 1;
}

/* Marks what a chain reaches; all, for a use as a whole. */
static void mark_use(void *user, const uint32_t *i)
{
    struct walk *walk = user;
    bool chain = spirv_is(i, SpvOpAccessChain) || spirv_is(i, SpvOpInBoundsAccessChain);
    uint32_t type = walk->leaf.types[0], first = 0, depth = 0;
    for (uint32_t word = 4; chain && word < spirv_length(i) && depth < walk->most_depth; word++) {
        const uint32_t *declared = spirv_definition(walk->module, type);
        uint32_t member = spirv_definition(walk->module, i[word])[3];
        if (!spirv_is_array(declared) && !has_members(declared))
            break;
        depth++;
        for (uint32_t k = 0; has_members(declared) && k < member; k++)
            first += count_leaves(walk, declared[2 + k], depth);
        type = declared[spirv_is_array(declared) ? 2 : 2 + member];
    }
    memset(walk->used + first, true, count_leaves(walk, type, depth));
}

static bool walk_type(struct walk *walk, uint32_t type)
{
    struct spirv_leaf *leaf = &walk->leaf;
    const uint32_t *declared = spirv_definition(walk->module, type);
    uint32_t depth = leaf->depth;
    size_t length = strlen(leaf->name), room = sizeof leaf->name - length;
    bool good = true;
    leaf->types[depth] = type;
    if (depth >= walk->most_depth || !(spirv_is_array(declared) || has_members(declared)))
        return !walk->used[walk->next++] || walk->take(walk->user, leaf);
    leaf->depth++;
    if (spirv_is_array(declared))
        good = walk_type(walk, declared[2]);
    for (uint32_t m = 0; good && has_members(declared) && m + 2 < spirv_length(declared); m++) {
        const char *name = spirv_own_name(spirv_member_name(walk->module, type, m));
        leaf->members[depth] = m;
        if (name && *name)
            snprintf(leaf->name + length, room, "%s%s", length ? "_" : "", name);
        else
            snprintf(leaf->name + length, room, "%s%u", length ? "_" : "", m);
        good = walk_type(walk, declared[2 + m]);
        leaf->name[length] = 0;
    }
    leaf->depth = depth;
    return good;
}

bool spirv_each_leaf(const struct spirv *module, const uint32_t *variable, const bool *live,
                     spirv_leaf_taker *take, void *user)
{
    struct walk walk = {.module = module, .most_depth = MOST_STEPS, .take = take, .user = user};
    uint32_t type = walk.leaf.types[0] = spirv_pointee(module, variable);
    bool block = spirv_decoration(module, spirv_element_type(module, type), SpvDecorationBlock) !=
                 UINT32_MAX;
    uint32_t count = count_leaves(&walk, type, 0);
    if (count > MOST_LEAVES)
        count = 1, walk.most_depth = 0;
    if (!block || !walk.most_depth)
        snprintf(walk.leaf.name, sizeof walk.leaf.name, "%s",
                 spirv_variable_name(module, variable));
    walk.used = calloc(count + 1, sizeof *walk.used);
    if (walk.used && live)
        each_use(module, live, variable[2], mark_use, &walk);
    else if (walk.used)
        memset(walk.used, true, count);
    bool good = walk.used && walk_type(&walk, type);
    free(walk.used);
    return good;
}
