/* See reflect.h. */
#include "import/reflect.h"

#include <spirv/unified1/spirv.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "diptych.h"
#include "formats.h"
#include "gen/glsl/initials.h"
#include "gen/model/foreign.h"
#include "gen/model/leaves.h"
#include "gen/read/body_files.h"
#include "gen/spirv/compile.h"
#include "gen/spirv/stages.h"
#include "gen/spirv/whole.h"
#include "scenes/child.h"

struct reflecting {
    const struct spirv *module;
    bool *live; /* by function */
    struct reflection *out;
    bool failed;
};

static struct reflected *append_reflected(struct reflecting *reader, enum reflected_kind kind,
                                          const char *name)
{
    struct reflection *out = reader->out;
    struct reflected *list = realloc(out->list, (out->count + 1) * sizeof *list);
    reader->failed |= !list;
    if (!list)
        return NULL;
    out->list = list;
    struct reflected *item = &list[out->count++];
    *item = (struct reflected){.kind = kind};
    snprintf(item->name, sizeof item->name, "%s", name);
    return item;
}

/* ---- Types ----------------------------------------------------------------------------------- */

/* Of its numbers, up to 2^56. An array without a length has one element. */
static uint64_t least_bytes(const struct spirv *module, uint32_t id)
{
    const uint64_t most = UINT64_C(1) << 56;
    const uint32_t *type = spirv_definition(module, id);
    uint64_t bytes = 0;
    if (spirv_is(type, SpvOpTypeInt) || spirv_is(type, SpvOpTypeFloat))
        return type[2] / 8;
    if (spirv_is(type, SpvOpTypeStruct))
        for (uint32_t m = 0; m + 2 < spirv_length(type); m++) {
            uint32_t offset = spirv_member_decoration(module, id, m, SpvDecorationOffset);
            uint64_t end = least_bytes(module, type[2 + m]) + (offset == UINT32_MAX ? 0 : offset);
            bytes = end > bytes ? end : bytes;
        }
    else if (spirv_is_array(type) || spirv_parts(module, type)) {
        uint32_t stride = spirv_decoration(module, id, SpvDecorationArrayStride);
        uint32_t length = spirv_is_array(type) ? spirv_array_length(module, type) : type[3];
        bytes = stride == UINT32_MAX ? least_bytes(module, type[2]) : stride;
        bytes = length && bytes > most / length ? most : bytes * (length ? length : 1);
    }
    return bytes < most ? bytes : most;
}

/* A type that a spec can say; "": another. */
static void set_type(struct reflected *item, bool known, struct text *type)
{
    if (known && !type->failed && type->length < sizeof item->type)
        memcpy(item->type, type->data, type->length + 1);
    text_free(type);
}

static void write_type(const struct reflecting *reader, uint32_t id, struct reflected *item)
{
    struct text type = {0};
    bool known = spirv_type_name(reader->module, id, &type);
    set_type(item, known, &type);
}

/* NULL: none that passes have. */
static const char *shape_of(const uint32_t *image)
{
    static const char *const shapes[][2] = {[SpvDim1D] = {NULL, NULL},
                                            [SpvDim2D] = {"2D", "2D array"},
                                            [SpvDim3D] = {"3D", "3D"},
                                            [SpvDimCube] = {"cube", "cube array"}};
    return image[6] || image[3] > SpvDimCube ? NULL : shapes[image[3]][image[5]];
}

/* The row of formats.def with this format of SPIR-V; NULL: none. */
static const char *storage_format(uint32_t format)
{
    for (int row = 0; row < DT_FORMAT_COUNT; row++) {
        const struct format_info *info = format_info((enum dt_format)row);
        if (info->qualifier && !strcmp(info->qualifier, spirv_image_format(format)))
            return info->name;
    }
    return NULL;
}

/* ---- Resources ------------------------------------------------------------------------------- */

/* Whether something is stored in the image; one that a function takes counts. */
static bool is_stored(const struct spirv *module, uint32_t image)
{
    bool stored = false;
    SPIRV_EACH(module, i, module->code, module->count) {
        const uint32_t *load = spirv_is(i, SpvOpImageWrite) ? spirv_definition(module, i[1]) : i;
        if (spirv_is(load, SpvOpLoad) ? load != i && load[3] == image
                                      : spirv_is(i, SpvOpImageTexelPointer) && i[3] == image)
            stored = true;
        for (uint32_t word = 4; spirv_is(i, SpvOpFunctionCall) && word < spirv_length(i); word++)
            stored |= i[word] == image;
    }
    return stored && spirv_decoration(module, image, SpvDecorationNonWritable) == UINT32_MAX;
}

/* Whether a value comes from the variable: by a load or an atomic operation, of an image also by a read; what a function takes counts. */
static bool gives_value(const struct spirv *module, uint32_t variable)
{
    bool *led = calloc(module->words[3], sizeof *led), found = !led; /* to the variable */
    if (led)
        led[variable] = true;
    SPIRV_EACH(module, i, module->code, found ? 0 : module->count) {
        uint32_t opcode = spirv_opcode(i);
        bool image = opcode == SpvOpLoad && led[i[3]] &&
                     spirv_is(spirv_definition(module, i[1]), SpvOpTypeImage);
        bool chain = opcode == SpvOpAccessChain || opcode == SpvOpInBoundsAccessChain ||
                     opcode == SpvOpImageTexelPointer || image;
        bool atomic = opcode >= SpvOpAtomicLoad && opcode <= SpvOpAtomicXor;
        if (chain)
            led[i[2]] = led[i[3]];
        else if (opcode == SpvOpLoad || opcode == SpvOpImageRead ||
                 (atomic && opcode != SpvOpAtomicStore))
            found |= led[i[3]];
        for (uint32_t word = 4; opcode == SpvOpFunctionCall && word < spirv_length(i); word++)
            found |= led[i[word]];
    }
    free(led);
    return found;
}

static void set_binding(const struct spirv *module, const uint32_t *variable,
                        struct reflected *item)
{
    item->set = spirv_decoration(module, variable[2], SpvDecorationDescriptorSet);
    item->binding = spirv_decoration(module, variable[2], SpvDecorationBinding);
}

static void add_image(struct reflecting *reader, const uint32_t *variable, enum reflected_kind kind)
{
    const struct spirv *module = reader->module;
    const uint32_t *type = spirv_definition(module, spirv_pointee(module, variable));
    struct reflected *item = append_reflected(reader, kind, spirv_variable_name(module, variable));
    if (!item)
        return;
    bool alone = !spirv_is_array(type);
    while (!spirv_is(type, SpvOpTypeImage))
        type = spirv_definition(module, type[2]);
    char letter = spirv_letter(spirv_definition(module, type[2]));
    item->shape = alone ? shape_of(type) : NULL;
    if (alone)
        spirv_image_name(module, type, kind == REFLECTED_TEXTURE, item->type, sizeof item->type);
    item->scalar = letter ? letter : 'f';
    item->depth = type[4] == 1;
    item->format = kind == REFLECTED_IMAGE ? storage_format(type[8]) : NULL;
    if (kind == REFLECTED_IMAGE && alone && type[8] && !item->format) {
        item->shape = NULL;
        snprintf(item->type, sizeof item->type, "of the format %s", spirv_image_format(type[8]));
    }
    item->writes = kind == REFLECTED_IMAGE && is_stored(module, variable[2]);
    item->reads = kind == REFLECTED_TEXTURE || gives_value(module, variable[2]);
    set_binding(module, variable, item);
}

static void add_buffer(struct reflecting *reader, const uint32_t *variable)
{
    const struct spirv *module = reader->module;
    uint32_t id = spirv_pointee(module, variable);
    const uint32_t *type = spirv_definition(module, id);
    struct reflected *item =
        append_reflected(reader, REFLECTED_BUFFER, spirv_variable_name(module, variable));
    if (!item)
        return;
    bool read_only = spirv_is(type, SpvOpTypeStruct);
    for (uint32_t m = 0; read_only && m + 2 < spirv_length(type); m++)
        read_only = spirv_member_decoration(module, id, m, SpvDecorationNonWritable) != UINT32_MAX;
    item->bytes = least_bytes(module, id);
    item->reads = gives_value(module, variable[2]);
    set_binding(module, variable, item);
    item->writes =
        !read_only && spirv_decoration(module, variable[2], SpvDecorationNonWritable) == UINT32_MAX;
    uint32_t last = type[spirv_length(type) - 1];
    uint32_t stride = spirv_decoration(module, last, SpvDecorationArrayStride);
    if (spirv_is(spirv_definition(module, last), SpvOpTypeRuntimeArray) && stride != UINT32_MAX)
        item->stride = stride;
    const uint32_t *member = spirv_is(type, SpvOpTypeStruct) && spirv_length(type) == 3
                                 ? spirv_definition(module, type[2])
                                 : type;
    if (!spirv_is_array(member) || spirv_is_array(spirv_definition(module, member[2])))
        return;
    write_type(reader, member[2], item);
    if (!strncmp(item->type, "mat", 3))
        *item->type = 0;
    if (*item->type)
        item->stride = 0;
}

struct leaves {
    struct reflecting *reader;
    enum reflected_kind kind;
    uint32_t location;
};

static bool add_leaf(void *user, const struct spirv_leaf *leaf)
{
    const struct leaves *leaves = user;
    const struct spirv *module = leaves->reader->module;
    struct reflected *item = append_reflected(leaves->reader, leaves->kind, leaf->name);
    struct text type = {0};
    if (!item)
        return false;
    bool known = spirv_leaf_type(module, leaf, &type);
    set_type(item, known, &type);
    uint32_t member = leaf->depth ? leaf->members[0] : 0;
    uint32_t own = spirv_member_decoration(module, leaf->types[0], member, SpvDecorationLocation);
    item->location = own < UINT32_MAX ? own : leaves->location + member;
    return true;
}

/* In the order of a spec. */
enum rank { TEXTURES, IMAGES, BUFFERS, BLOCKS, PUSH, INPUTS, OUTPUTS, RANKS };

static enum rank rank_of(const struct spirv *module, const uint32_t *variable)
{
    uint32_t id = spirv_element_type(module, spirv_pointee(module, variable));
    const uint32_t *type = spirv_definition(module, id);
    bool built_in = spirv_decoration(module, variable[2], SpvDecorationBuiltIn) != UINT32_MAX ||
                    spirv_member_decoration(module, id, 0, SpvDecorationBuiltIn) != UINT32_MAX;
    switch (variable[3]) {
    case SpvStorageClassUniformConstant:
        return spirv_is(type, SpvOpTypeSampledImage)            ? TEXTURES
               : spirv_is(type, SpvOpTypeImage) && type[7] == 2 ? IMAGES
                                                                : RANKS;
    case SpvStorageClassUniform:
        return spirv_decoration(module, id, SpvDecorationBufferBlock) != UINT32_MAX ? BUFFERS
                                                                                    : BLOCKS;
    case SpvStorageClassStorageBuffer:
        return BUFFERS;
    case SpvStorageClassPushConstant:
        return PUSH;
    case SpvStorageClassInput:
        return built_in ? RANKS : INPUTS;
    case SpvStorageClassOutput:
        return built_in ? RANKS : OUTPUTS;
    default:
        return RANKS;
    }
}

static void add_variable(struct reflecting *reader, const uint32_t *variable, enum rank rank)
{
    static const enum reflected_kind kinds[RANKS] = {
        REFLECTED_TEXTURE, REFLECTED_IMAGE, REFLECTED_BUFFER, REFLECTED_VALUE,
        REFLECTED_VALUE,   REFLECTED_INPUT, REFLECTED_OUTPUT};
    const struct spirv *module = reader->module;
    uint32_t second = spirv_decoration(module, variable[2], SpvDecorationIndex);
    struct leaves leaves = {reader, kinds[rank],
                            second && second != UINT32_MAX
                                ? MOST_TARGETS
                                : spirv_decoration(module, variable[2], SpvDecorationLocation)};
    if (rank <= IMAGES)
        add_image(reader, variable, kinds[rank]);
    else if (rank == BUFFERS)
        add_buffer(reader, variable);
    else
        reader->failed |= !spirv_each_leaf(module, variable, rank == OUTPUTS ? NULL : reader->live,
                                           add_leaf, &leaves);
}

/* Named constants of specialization, by their defaults. */
static void add_constants(struct reflecting *reader)
{
    const struct spirv *module = reader->module;
    SPIRV_EACH(module, i, module->declarations, module->code) {
        bool truth = spirv_is(i, SpvOpSpecConstantTrue), number = spirv_is(i, SpvOpSpecConstant);
        const char *name = spirv_name(module, spirv_result(i));
        bool own = truth || number || spirv_is(i, SpvOpSpecConstantFalse);
        own &= name && *name && spirv_decoration(module, i[2], SpvDecorationSpecId) != UINT32_MAX;
        struct reflected *item = own ? append_reflected(reader, REFLECTED_CONSTANT, name) : NULL;
        if (!item)
            continue;
        if (truth || spirv_letter(spirv_definition(module, i[1])))
            write_type(reader, i[1], item);
        float real = 0;
        if (number)
            memcpy(&real, i + 3, sizeof real);
        item->number = !number                        ? truth
                       : !strcmp(item->type, "float") ? (double)real
                       : !strcmp(item->type, "int")   ? (double)(int32_t)i[3]
                                                      : (double)i[3];
    }
}

/* What main uses. */
static bool add_variables(struct reflecting *reader)
{
    const struct spirv *module = reader->module;
    reader->live = spirv_live_functions(module);
    for (int rank = 0; reader->live && rank < RANKS; rank++)
        SPIRV_EACH(module, i, module->declarations, module->code)
            if (spirv_is(i, SpvOpVariable) && rank_of(module, i) == (enum rank)rank &&
                spirv_mentions(module, reader->live, i[2]))
                add_variable(reader, i, (enum rank)rank);
    SPIRV_EACH(module, i, SPIRV_HEADER, module->declarations) {
        if (spirv_is(i, SpvOpExecutionMode) && i[2] == SpvExecutionModeLocalSize)
            memcpy(reader->out->local, i + 3, sizeof reader->out->local);
        if (spirv_is(i, SpvOpCapability))
            reader->out->subgroups |=
                i[1] >= SpvCapabilityGroupNonUniform && i[1] <= SpvCapabilityGroupNonUniformQuad;
        if (spirv_is(i, SpvOpDecorate) && i[2] == SpvDecorationBuiltIn && reader->live &&
            (i[3] == SpvBuiltInGlobalInvocationId || i[3] == SpvBuiltInWorkgroupId))
            reader->out->spread |= spirv_mentions(module, reader->live, i[1]);
    }
    bool good = reader->live && !reader->failed;
    free(reader->live);
    return good;
}

/* ---- Text ------------------------------------------------------------------------------------ */

/* With #version 460 in front, and blanks for its own. */
static char *prepare(const char *text, int stage)
{
    static const char *const stages[] = {"COMPUTE", "VERTEX", "FRAGMENT"};
    char *all = format_string("#version 460\n#define %s\n#line 1\n%s", stages[stage], text);
    char *code = strdup(text);
    if (code)
        blank_comments(code);
    char *own = code ? find_version(code) : NULL;
    if (all && own)
        memset(all + strlen(all) - strlen(own), ' ', strcspn(own, "\r\n"));
    free(code);
    return all;
}

/* Gives constants of specialization the values that the spec will have: two of them may have one number. */
static bool specialize(const struct reflection *reflection, struct spirv *module)
{
    char *why = NULL;
    struct pipeline pipeline = {.params = calloc(reflection->count + 1, sizeof *pipeline.params)};
    for (uint32_t i = 0; pipeline.params && i < reflection->count; i++)
        if (*reflection->list[i].type)
            pipeline.params[pipeline.param_count++] =
                (struct param){.name = reflection->list[i].name,
                               .components = 1,
                               .value = {reflection->list[i].number}};
    bool good = pipeline.params && whole_specialize(&pipeline, module, &why);
    free(why);
    free(pipeline.params);
    return good;
}

/* Takes over the words. */
static bool reflect_words(uint32_t *words, size_t count, struct reflection *reflection)
{
    struct spirv module;
    struct reflecting reader = {.module = &module, .out = reflection};
    bool good = spirv_read(&module, words, count) && spirv_combine(&module) &&
                spirv_locate(&module, SpvStorageClassInput) &&
                spirv_locate(&module, SpvStorageClassOutput);
    if (good)
        add_constants(&reader);
    good = good && specialize(reflection, &module) && add_variables(&reader);
    spirv_free(&module);
    return good;
}

bool reflect_module(const uint32_t *words, size_t count, int stage, struct reflection *reflection,
                    char **why)
{
    static const uint32_t models[] = {SpvExecutionModelGLCompute, SpvExecutionModelVertex,
                                      SpvExecutionModelFragment};
    struct spirv module = {0};
    *reflection = (struct reflection){0};
    *why = NULL;
    uint32_t *own = spirv_take_in(words, &count, "");
    bool good =
        own && spirv_read(&module, own, count) && spirv_choose_entry(&module, models[stage]);
    own = spirv_take(&module, &count);
    return good && reflect_words(own, count, reflection);
}

void reflect_initial(void *user, const char *name, const char *value)
{
    struct reflection *reflection = user;
    for (uint32_t i = 0; i < reflection->count; i++) {
        struct reflected *item = &reflection->list[i];
        if (item->kind == REFLECTED_VALUE && !item->initial && !strcmp(item->name, name))
            item->initial = strdup(value);
    }
}

enum { STAGE_SECONDS = 20 };

bool reflect(const char *text, int stage,
             bool (*include)(const void *user, const char *from, const char *name,
                             struct glslang_file *file),
             const void *user, struct reflection *reflection, char **why)
{
    char *code = prepare(text, stage);
    const struct glslang_job job = {
        .code = code, .stage = stage, .minor = 5, .whole = true, .include = include, .user = user};
    size_t count = 0;
    *why = NULL;
    *reflection = (struct reflection){0};
    child_limit_time(STAGE_SECONDS); /* macros that double for ever */
    uint32_t *words = code && spirv_init(true) ? glsl_compile_whole(&job, &count, why) : NULL;
    bool good = words && reflect_words(words, count, reflection);
    if (good)
        glsl_initials(&job, reflect_initial, reflection);
    free(code);
    return good;
}

void reflect_free(struct reflection *reflection)
{
    for (uint32_t i = 0; i < reflection->count; i++)
        free(reflection->list[i].initial);
    free(reflection->list);
    *reflection = (struct reflection){0};
}
