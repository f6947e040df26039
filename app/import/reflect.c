/* See reflect.h. */
#include "import/reflect.h"

#include <spirv_cross/spirv_cross_c.h>
#include <stdio.h>
#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "base/text.h"
#include "diptych.h"
#include "formats.h"
#include "gen/glsl/initials.h"
#include "gen/model/foreign.h"
#include "gen/model/leaves.h"
#include "gen/model/spirv_check.h"
#include "gen/spirv/compile.h"
#include "gen/spirv/stages.h"

struct reflecting {
    const struct spirv *module;
    bool *live; /* by function */
    spvc_compiler compiler;
    spvc_resources resources;
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

/* Of its numbers, up to 2^56: SPIRV-Cross counts in 32 bits. */
static uint64_t least_bytes(spvc_compiler compiler, spvc_type type)
{
    const uint64_t most = UINT64_C(1) << 56;
    uint64_t bytes = 4 * spvc_type_get_vector_size(type) * spvc_type_get_columns(type);
    for (unsigned i = 0; i < spvc_type_get_num_member_types(type); i++)
        bytes += least_bytes(
            compiler, spvc_compiler_get_type_handle(compiler, spvc_type_get_member_type(type, i)));
    for (unsigned i = 0; i < spvc_type_get_num_array_dimensions(type); i++) {
        SpvId length = spvc_type_get_array_dimension(type, i); /* 0: at run time */
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

static const char *shape_of(spvc_type type)
{
    bool array = spvc_type_get_image_arrayed(type);
    if (spvc_type_get_image_multisampled(type) || spvc_type_get_num_array_dimensions(type))
        return NULL;
    switch (spvc_type_get_image_dimension(type)) {
    case SpvDim2D:
        return array ? "2D array" : "2D";
    case SpvDim3D:
        return "3D";
    case SpvDimCube:
        return array ? NULL : "cube";
    default:
        return NULL;
    }
}

static char scalar_name(spvc_compiler compiler, spvc_type type)
{
    spvc_type sampled =
        spvc_compiler_get_type_handle(compiler, spvc_type_get_image_sampled_type(type));
    spvc_basetype base = spvc_type_get_basetype(sampled);
    return base == SPVC_BASETYPE_INT32 ? 'i' : base == SPVC_BASETYPE_UINT32 ? 'u' : 'f';
}

/* The row of formats.def with this format of SPIR-V; NULL: none. */
static const char *storage_format(spvc_type type)
{
    static const struct {
        SpvImageFormat format;
        const char *qualifier;
    } names[] = {{SpvImageFormatRgba32f, "rgba32f"},
                 {SpvImageFormatRgba16f, "rgba16f"},
                 {SpvImageFormatR32f, "r32f"},
                 {SpvImageFormatRgba8, "rgba8"},
                 {SpvImageFormatRg32f, "rg32f"},
                 {SpvImageFormatRg16f, "rg16f"},
                 {SpvImageFormatR11fG11fB10f, "r11f_g11f_b10f"},
                 {SpvImageFormatR16f, "r16f"},
                 {SpvImageFormatRgba16, "rgba16"},
                 {SpvImageFormatRgb10A2, "rgb10_a2"},
                 {SpvImageFormatRg16, "rg16"},
                 {SpvImageFormatRg8, "rg8"},
                 {SpvImageFormatR16, "r16"},
                 {SpvImageFormatR8, "r8"},
                 {SpvImageFormatRgba16Snorm, "rgba16_snorm"},
                 {SpvImageFormatRg16Snorm, "rg16_snorm"},
                 {SpvImageFormatR16Snorm, "r16_snorm"},
                 {SpvImageFormatRgba32i, "rgba32i"},
                 {SpvImageFormatRgba16i, "rgba16i"},
                 {SpvImageFormatRgba8i, "rgba8i"},
                 {SpvImageFormatR32i, "r32i"},
                 {SpvImageFormatRg32i, "rg32i"},
                 {SpvImageFormatRg16i, "rg16i"},
                 {SpvImageFormatRg8i, "rg8i"},
                 {SpvImageFormatR16i, "r16i"},
                 {SpvImageFormatR8i, "r8i"},
                 {SpvImageFormatRgba32ui, "rgba32ui"},
                 {SpvImageFormatRgba16ui, "rgba16ui"},
                 {SpvImageFormatRgba8ui, "rgba8ui"},
                 {SpvImageFormatR32ui, "r32ui"},
                 {SpvImageFormatRg32ui, "rg32ui"},
                 {SpvImageFormatRg16ui, "rg16ui"},
                 {SpvImageFormatRg8ui, "rg8ui"},
                 {SpvImageFormatR16ui, "r16ui"},
                 {SpvImageFormatR8ui, "r8ui"}};
    SpvImageFormat format = spvc_type_get_image_storage_format(type);
    for (size_t i = 0; i < DT_ARRAY_COUNT(names); i++)
        for (int row = 0; names[i].format == format && row < DT_FORMAT_COUNT; row++) {
            const struct format_info *info = format_info((enum dt_format)row);
            if (info->qualifier && !strcmp(info->qualifier, names[i].qualifier))
                return info->name;
        }
    return NULL;
}

/* ---- Resources ------------------------------------------------------------------------------- */

static const char *reflected_name(const struct reflecting *reader,
                                  const spvc_reflected_resource *resource)
{
    const char *name = spvc_compiler_get_name(reader->compiler, resource->id);
    return name && *name ? name : spvc_compiler_get_name(reader->compiler, resource->base_type_id);
}

/* Whether something is stored in the image; one that a function takes counts. */
static bool is_stored(const struct spirv *module, uint32_t image)
{
    bool stored = false;
    SPIRV_EACH(module, at, module->code, module->count)
    {
        const uint32_t *i = module->words + at;
        const uint32_t *load = spirv_is(i, SpvOpImageWrite) ? spirv_definition(module, i[1]) : i;
        if (spirv_is(load, SpvOpLoad) ? load != i && load[3] == image
                                      : spirv_is(i, SpvOpImageTexelPointer) && i[3] == image)
            stored = true;
        for (uint32_t word = 4; spirv_is(i, SpvOpFunctionCall) && word < spirv_length(i); word++)
            stored |= i[word] == image;
    }
    return stored && spirv_decoration(module, image, SpvDecorationNonWritable) == UINT32_MAX;
}

static void add_image(struct reflecting *reader, const spvc_reflected_resource *resource,
                      enum reflected_kind kind)
{
    spvc_type type = spvc_compiler_get_type_handle(reader->compiler, resource->type_id);
    struct reflected *item = append_reflected(reader, kind, reflected_name(reader, resource));
    if (!item)
        return;
    item->shape = shape_of(type);
    item->scalar = scalar_name(reader->compiler, type);
    item->depth = spvc_type_get_image_is_depth(type);
    item->format = kind == REFLECTED_IMAGE ? storage_format(type) : NULL;
    item->writes = kind == REFLECTED_IMAGE && is_stored(reader->module, resource->id);
}

/* Whether all members have the decoration, or the block itself. */
static bool is_decorated(const struct reflecting *reader, const spvc_reflected_resource *resource,
                         SpvDecoration decoration)
{
    spvc_type type = spvc_compiler_get_type_handle(reader->compiler, resource->base_type_id);
    bool all = spvc_type_get_num_member_types(type);
    for (unsigned i = 0; i < spvc_type_get_num_member_types(type); i++)
        all &= spvc_compiler_has_member_decoration(reader->compiler, resource->base_type_id, i,
                                                   decoration);
    return all || spvc_compiler_has_decoration(reader->compiler, resource->id, decoration);
}

static void reflect_buffer(struct reflecting *reader, const spvc_reflected_resource *resource)
{
    spvc_type type = spvc_compiler_get_type_handle(reader->compiler, resource->base_type_id);
    struct reflected *item =
        append_reflected(reader, REFLECTED_BUFFER, reflected_name(reader, resource));
    size_t bytes = 0;
    if (!item)
        return;
    item->bytes = least_bytes(reader->compiler, type);
    item->writes = !is_decorated(reader, resource, SpvDecorationNonWritable);
    spvc_compiler_get_declared_struct_size(reader->compiler, type, &bytes);
    item->bytes = bytes > item->bytes ? bytes : item->bytes;
    if (spvc_type_get_num_member_types(type) != 1)
        return;
    spvc_type member =
        spvc_compiler_get_type_handle(reader->compiler, spvc_type_get_member_type(type, 0));
    if (spvc_type_get_num_array_dimensions(member) != 1)
        return;
    write_type(reader, spvc_type_get_base_type_id(member), item);
    if (!strncmp(item->type, "mat", 3))
        *item->type = 0;
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

/* Uniforms and inputs: what the shader uses of them. Outputs. */
static void add_leaves(struct reflecting *reader, const spvc_reflected_resource *resource,
                       enum reflected_kind kind)
{
    struct leaves leaves = {reader, kind,
                            spirv_decoration(reader->module, resource->id, SpvDecorationLocation)};
    reader->failed |=
        !spirv_each_leaf(reader->module, spirv_definition(reader->module, resource->id),
                         kind == REFLECTED_OUTPUT ? NULL : reader->live, add_leaf, &leaves);
}

static void add_resource(struct reflecting *reader, const spvc_reflected_resource *resource,
                         spvc_resource_type type)
{
    switch (type) {
    case SPVC_RESOURCE_TYPE_UNIFORM_BUFFER:
    case SPVC_RESOURCE_TYPE_PUSH_CONSTANT:
        add_leaves(reader, resource, REFLECTED_VALUE);
        break;
    case SPVC_RESOURCE_TYPE_STORAGE_BUFFER:
        reflect_buffer(reader, resource);
        break;
    case SPVC_RESOURCE_TYPE_STORAGE_IMAGE:
    case SPVC_RESOURCE_TYPE_SAMPLED_IMAGE:
        add_image(reader, resource,
                  type == SPVC_RESOURCE_TYPE_SAMPLED_IMAGE ? REFLECTED_TEXTURE : REFLECTED_IMAGE);
        break;
    default:
        add_leaves(reader, resource,
                   type == SPVC_RESOURCE_TYPE_STAGE_INPUT ? REFLECTED_INPUT : REFLECTED_OUTPUT);
    }
}

/* Named constants of specialization, by their defaults. *any: there are some, also without a name. */
static void add_constants(struct reflecting *reader, bool *any)
{
    const struct spirv *module = reader->module;
    SPIRV_EACH(module, at, module->declarations, module->code)
    {
        const uint32_t *i = module->words + at;
        bool truth = spirv_is(i, SpvOpSpecConstantTrue), number = spirv_is(i, SpvOpSpecConstant);
        const char *name = spirv_name(module, spirv_result(i));
        bool own = truth || number || spirv_is(i, SpvOpSpecConstantFalse);
        *any |= own || spirv_is(i, SpvOpSpecConstantOp);
        own &= name && *name && spirv_decoration(module, i[2], SpvDecorationSpecId) != UINT32_MAX;
        struct reflected *item = own ? append_reflected(reader, REFLECTED_CONSTANT, name) : NULL;
        if (!item)
            continue;
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

static bool reflect_all(struct reflecting *reader)
{
    static const spvc_resource_type types[] = {
        SPVC_RESOURCE_TYPE_SAMPLED_IMAGE,  SPVC_RESOURCE_TYPE_STORAGE_IMAGE,
        SPVC_RESOURCE_TYPE_STORAGE_BUFFER, SPVC_RESOURCE_TYPE_UNIFORM_BUFFER,
        SPVC_RESOURCE_TYPE_PUSH_CONSTANT,  SPVC_RESOURCE_TYPE_STAGE_INPUT,
        SPVC_RESOURCE_TYPE_STAGE_OUTPUT};
    for (size_t t = 0; t < DT_ARRAY_COUNT(types); t++) {
        const spvc_reflected_resource *list = NULL;
        size_t count = 0;
        if (spvc_resources_get_resource_list_for_type(reader->resources, types[t], &list, &count) !=
            SPVC_SUCCESS)
            return false;
        for (size_t i = 0; i < count; i++)
            add_resource(reader, &list[i], types[t]);
    }
    for (unsigned i = 0; i < 3; i++)
        reader->out->local[i] = spvc_compiler_get_execution_mode_argument_by_index(
            reader->compiler, SpvExecutionModeLocalSize, i);
    return !reader->failed;
}

static bool read_module(spvc_context context, const struct spirv *module,
                        struct reflection *reflection)
{
    spvc_parsed_ir ir = NULL;
    spvc_set active = NULL;
    struct reflecting reader = {
        .module = module, .live = spirv_live_functions(module), .out = reflection};
    bool good =
        reader.live &&
        spvc_context_parse_spirv(context, module->words, module->count, &ir) == SPVC_SUCCESS &&
        spvc_context_create_compiler(context, SPVC_BACKEND_NONE, ir,
                                     SPVC_CAPTURE_MODE_TAKE_OWNERSHIP,
                                     &reader.compiler) == SPVC_SUCCESS &&
        spvc_compiler_get_active_interface_variables(reader.compiler, &active) == SPVC_SUCCESS &&
        spvc_compiler_create_shader_resources_for_active_variables(
            reader.compiler, &reader.resources, active) == SPVC_SUCCESS &&
        reflect_all(&reader);
    free(reader.live);
    return good;
}

/* ---- Text ------------------------------------------------------------------------------------ */

/* With #version 460 in front, and blanks for its own. */
static char *prepare(const char *text, int stage)
{
    static const char *const stages[] = {"COMPUTE", "VERTEX", "FRAGMENT"};
    char *all = format_string("#version 460\n#define %s\n#line 1\n%s", stages[stage], text);
    char *own = all ? strstr(all + 1, "#version") : NULL;
    if (own)
        memset(own, ' ', strcspn(own, "\r\n"));
    return all;
}

/* Takes over the words. */
static bool reflect_words(uint32_t *words, size_t count, struct reflection *reflection, char **why)
{
    struct spirv module;
    spvc_context context = NULL;
    bool located = spirv_read(&module, words, count) && spirv_combine(&module) &&
                   spirv_locate(&module, SpvStorageClassInput) &&
                   spirv_locate(&module, SpvStorageClassOutput);
    struct reflecting reader = {.module = &module, .out = reflection};
    bool any = false;
    if (located)
        add_constants(&reader, &any);
    if (any) { /* SPIRV-Cross crashes where one is the length of an array */
        size_t length = module.count;
        uint32_t *frozen = spirv_optimize(module.words, &length, SPIRV_FREEZE);
        spirv_free(&module);
        located = spirv_read(&module, frozen, length);
    }
    bool good = located && !reader.failed && spvc_context_create(&context) == SPVC_SUCCESS &&
                read_module(context, &module, reflection);
    if (!good && context)
        *why = strdup(spvc_context_get_last_error_string(context));
    if (context)
        spvc_context_destroy(context);
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
    return good && reflect_words(own, count, reflection, why);
}

/* In a block a bool is a uint: bvec2(true, false) is uvec2(1, 0). */
static void take_initial(void *user, const char *name, const char *value)
{
    struct reflection *reflection = user;
    for (uint32_t i = 0; i < reflection->count; i++) {
        struct reflected *item = &reflection->list[i];
        struct text text = {0};
        if (item->kind != REFLECTED_VALUE || item->initial || strcmp(item->name, name) != 0)
            continue;
        text_add(&text, "%s", *value == 'b' ? item->type : value);
        for (const char *at = *value == 'b' ? strchr(value, '(') : ""; *at; at++)
            if (!isalpha((unsigned char)*at))
                text_add(&text, "%c", *at);
            else if (*at == 't' || *at == 'f')
                text_add(&text, *at == 't' ? "1" : "0");
        item->initial = text.data;
    }
}

bool reflect(const char *text, int stage,
             bool (*include)(const void *user, const char *from, const char *name,
                             struct glslang_file *file),
             const void *user, struct reflection *reflection, char **why)
{
    char *code = prepare(text, stage);
    const struct glslang_job job = {
        .code = code, .stage = stage, .whole = true, .include = include, .user = user};
    size_t count = 0;
    *why = NULL;
    *reflection = (struct reflection){0};
    uint32_t *words = code && spirv_init() ? glslang_compile(&job, &count, why) : NULL;
    bool good = words && reflect_words(words, count, reflection, why);
    if (good)
        glsl_initials(&job, take_initial, reflection);
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
