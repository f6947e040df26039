/* See values.h. An image is found from an instruction back to its variable: by loads, through samplers, and through parameters
 * of functions, which may have several callers. Filtered samples are not here: glsl_access.c filters by texels, and prove.c names
 * those that are left. Blending reads what is stored, so the driver rounds a target that is blended all the same. */
#include "values.h"

#include <spirv/unified1/spirv.h>
#include <stdio.h>
#include <stdlib.h>
#include <xxhash.h>

#include "formats.h"
#include "link.h"

struct values {
    const struct spirv *from;
    const struct pass *pass;
    struct spirv_edit edit;
    struct spirv_link link;
    char **why;
};

/* Beside enum dt_format; CODES: of DT_FORMAT_RGBA8_SRGB without sRGB. */
enum { NO_FORMAT = -1, FORMATS_DIFFER = -2, CODES = -3 };

/* ---- Formats --------------------------------------------------------------------------------- */

/* What the library calls it; NULL: texels of 32 bits, or a conversion that only drivers have. */
static const char *format_word(int format, bool read)
{
    static const char *const words[] = {
        [NUMBER_UNORM8] = "unorm8", [NUMBER_UNORM16] = "unorm16", [NUMBER_SNORM16] = "snorm16",
        [NUMBER_HALF] = "half",     [NUMBER_R11F] = "r11g11b10",  [NUMBER_R10] = "rgb10a2",
        [NUMBER_UINT8] = "uint8",   [NUMBER_INT8] = "int8",       [NUMBER_UINT16] = "uint16",
        [NUMBER_INT16] = "int16"};
    if (format == CODES)
        return read ? "codes" : NULL;
    if (format < 0)
        return NULL;
    if (format == DT_FORMAT_RGBA8_SRGB)
        return read ? "srgb" : NULL;
    return words[format_info((enum dt_format)format)->kind];
}

static int format_at(const struct pass *pass, int binding)
{
    if (binding >= 0 && binding == pass->textures_binding)
        return pass->codes ? CODES : DT_FORMAT_RGBA8_SRGB;
    for (uint32_t i = 0; i < pass->access_count && binding >= 0; i++) {
        const struct access *access = &pass->accesses[i];
        if (access->binding != binding)
            continue;
        if (access->codes)
            return CODES;
        if (access->resource && access->resource->kind == DT_IMAGE)
            return access->resource->format;
        if (access->builtin == DT_SCENE_TEXTURES)
            return DT_FORMAT_RGBA8_SRGB;
    }
    return NO_FORMAT;
}

static int format_of_target(const struct pass *pass, int attachment)
{
    EACH(access, pass->accesses, pass->access_count)
        if (access->kind & DT_WRITE_COLOR && access->attachment == attachment)
            return access->resource->format;
    return NO_FORMAT;
}

uint64_t spirv_formats(const struct pass *pass)
{
    uint64_t hash = pass->codes;
    for (uint32_t i = 0; i < pass->access_count && !pass->fast; i++) {
        const struct access *access = &pass->accesses[i];
        const int32_t key[] = {access->binding, access->attachment,
                               access->codes ? CODES
                               : access->resource && access->resource->kind == DT_IMAGE
                                   ? (int32_t)access->resource->format
                                   : NO_FORMAT};
        hash = XXH3_64bits_withSeed(key, sizeof key, hash);
    }
    return hash;
}

/* ---- Images ---------------------------------------------------------------------------------- */

static int format_of_image(const struct values *values, uint32_t image);

/* Of what all callers give for a parameter. */
static int format_of_parameter(const struct values *values, uint32_t parameter)
{
    const struct spirv *from = values->from;
    uint32_t function, index = spirv_parameter_index(from, parameter, &function);
    int format = NO_FORMAT;
    SPIRV_EACH(from, i, from->code, from->count) {
        if (!spirv_is(i, SpvOpFunctionCall) || i[3] != function)
            continue;
        int given = format_of_image(values, i[4 + index]);
        if (format != NO_FORMAT && given != format)
            return FORMATS_DIFFER;
        format = given;
    }
    return format;
}

static int format_of_image(const struct values *values, uint32_t image)
{
    const uint32_t *i = spirv_definition(values->from, image);
    switch (spirv_opcode(i)) {
    case SpvOpVariable:
        return format_at(values->pass,
                         (int)spirv_decoration(values->from, image, SpvDecorationBinding));
    case SpvOpFunctionParameter:
        return format_of_parameter(values, image);
    case SpvOpLoad:
    case SpvOpImage:
    case SpvOpSampledImage:
    case SpvOpAccessChain:
    case SpvOpCopyObject:
        return format_of_image(values, i[3]);
    default:
        return NO_FORMAT;
    }
}

static void refuse_values(struct values *values, const char *format)
{
    if (!*values->why)
        *values->why = format_string(format, values->pass->name);
}

/* The library's function for texels of four of these components; 0: none. */
static uint32_t find_function(struct values *values, int format, bool read, uint32_t component)
{
    const char *word = format_word(format, read);
    char letter = spirv_letter(spirv_definition(values->from, component)), mangled[40];
    if (format == FORMATS_DIFFER)
        refuse_values(values, "a function of the pass %s reads images of different formats by one "
                              "parameter, which exact passes cannot; give each format a function, "
                              "or set `exactness: fast`");
    if (!word || !letter)
        return 0;
    snprintf(mangled, sizeof mangled, "%s_%s(v%c4;", read ? "decode" : "store", word, letter);
    return spirv_link_function(&values->link, mangled);
}

/* The type of the components of texels. */
static uint32_t component_of(const struct values *values, uint32_t type)
{
    const uint32_t *vector = spirv_definition(values->from, type);
    return spirv_is(vector, SpvOpTypeVector) && vector[3] == 4 ? vector[2] : 0;
}

bool spirv_samples_codes(const struct spirv *module, const struct pass *pass)
{
    const struct values values = {.from = module, .pass = pass};
    SPIRV_EACH(module, i, module->code, module->count) {
        uint32_t operation = spirv_opcode(i);
        if (operation >= SpvOpImageSampleImplicitLod && operation <= SpvOpImageDrefGather &&
            operation != SpvOpImageFetch && format_of_image(&values, i[3]) == CODES)
            return true;
    }
    return false;
}

/* ---- Instructions ---------------------------------------------------------------------------- */

static bool put_decoded(struct values *values, const uint32_t *read)
{
    struct spirv_edit *edit = &values->edit;
    if (!spirv_is(read, SpvOpImageFetch) && !spirv_is(read, SpvOpImageRead))
        return false;
    uint32_t component = component_of(values, read[1]);
    uint32_t function =
        component ? find_function(values, format_of_image(values, read[3]), true, component) : 0;
    if (!function)
        return false;
    uint32_t texel = edit->bound++;
    spirv_copy_with(edit, &edit->code, read, 2, texel);
    SPIRV_PUT(edit, &edit->code, SpvOpFunctionCall, read[1], read[2], function, texel);
    return true;
}

static bool put_rounded(struct values *values, const uint32_t *write)
{
    struct spirv_edit *edit = &values->edit;
    if (!spirv_is(write, SpvOpImageWrite))
        return false;
    uint32_t type = spirv_definition(values->from, write[3])[1];
    uint32_t component = component_of(values, type);
    uint32_t function =
        component ? find_function(values, format_of_image(values, write[1]), false, component) : 0;
    if (!function)
        return false;
    uint32_t value = SPIRV_VALUE(edit, &edit->code, SpvOpFunctionCall, type, function, write[3]);
    spirv_copy_with(edit, &edit->code, write, 3, value);
    return true;
}

/* Rounds a colour target where the shader ends. One of less than four components is widened for that. */
static void put_target(struct values *values, const uint32_t *variable)
{
    struct spirv_edit *edit = &values->edit;
    const struct spirv *from = values->from;
    int format = format_of_target(values->pass,
                                  (int)spirv_decoration(from, variable[2], SpvDecorationLocation));
    uint32_t type = spirv_definition(from, variable[1])[3];
    const uint32_t *declared = spirv_definition(from, type);
    bool vector = spirv_is(declared, SpvOpTypeVector);
    uint32_t scalar = vector ? declared[2] : type, count = vector ? declared[3] : 1;
    uint32_t function = 0;
    if (spirv_is(declared, SpvOpTypeArray) ||
        (int)spirv_decoration(from, variable[2], SpvDecorationComponent) > 0)
        refuse_values(values, "the pass %s declares an array of colour targets, or one in parts, "
                              "which exact passes cannot; give each a variable, or set `exactness: "
                              "fast`");
    else
        function = find_function(values, format, false, scalar);
    if (!function)
        return;
    uint32_t four = spirv_declare_vector(edit, scalar, 4);
    uint32_t value = edit->bound++, rounded = edit->bound++;
    SPIRV_PUT(edit, &edit->code, SpvOpLoad, type, value, variable[2]);
    if (count < 4) {
        uint32_t zero = SPIRV_DECLARE(edit, SpvOpConstant, scalar, 0);
        uint32_t parts[6] = {four, edit->bound++, value, zero, zero, zero};
        spirv_put(edit, &edit->code, SpvOpCompositeConstruct, parts, 2 + 1 + 4 - count);
        value = parts[1];
    }
    SPIRV_PUT(edit, &edit->code, SpvOpFunctionCall, four, rounded, function, value);
    if (count < 4) {
        uint32_t shuffle[7] = {type, edit->bound++, rounded, rounded, 0, 1, 2}, part = shuffle[1];
        if (count == 1)
            SPIRV_PUT(edit, &edit->code, SpvOpCompositeExtract, type, part, rounded, 0);
        else
            spirv_put(edit, &edit->code, SpvOpVectorShuffle, shuffle, 4 + count);
        rounded = part;
    }
    SPIRV_PUT(edit, &edit->code, SpvOpStore, variable[2], rounded);
}

static void put_targets(struct values *values)
{
    const struct spirv *from = values->from;
    SPIRV_EACH(from, i, from->declarations, from->code)
        if (spirv_is(i, SpvOpVariable) && i[3] == SpvStorageClassOutput &&
            spirv_decoration(from, i[2], SpvDecorationLocation) != UINT32_MAX)
            put_target(values, i);
}

bool spirv_values(struct spirv *module, const struct pass *pass, char **why)
{
    char *refused = NULL;
    struct values values = {.from = module, .pass = pass, .why = &refused};
    struct spirv_edit *edit = &values.edit;
    const uint32_t *point = spirv_entry_point(module);
    uint32_t entry = point[1] == SpvExecutionModelFragment ? point[2] : 0, function = 0;
    spirv_edit_begin(edit, module);
    spirv_link_begin(&values.link, edit);
    spirv_edit_annotations(edit);
    SPIRV_EACH(module, instruction, module->code, edit->failed ? module->code : module->count) {
        if (spirv_is(instruction, SpvOpFunction))
            function = instruction[2];
        if (spirv_is(instruction, SpvOpReturn) && function == entry)
            put_targets(&values);
        if (!put_decoded(&values, instruction) && !put_rounded(&values, instruction))
            spirv_copy(edit, &edit->code, instruction);
    }
    spirv_link_end(&values.link);
    bool good = spirv_edit_end(edit, module) && !refused;
    if (refused) {
        free(*why);
        *why = refused;
    }
    return good;
}
