/* See cross.h. */
#include "cross.h"

#include <spirv/unified1/spirv.h>
#include <spirv_cross/spirv_cross_c.h>
#include <stdio.h>
#include <string.h>

/* Of a module: words before the first instruction, words of one, and its opcode. */
enum { HEADER = 5 };

static uint32_t length_of(const uint32_t *instruction)
{
    return *instruction >> 16;
}

static bool is(const uint32_t *instruction, SpvOp opcode)
{
    return (*instruction & 0xffff) == opcode;
}

/* An unnamed block gets the name of its type, "vpls_block", as SPIRV-Cross would number it. */
static void name_blocks(spvc_compiler compiler, spvc_resources resources, spvc_resource_type type)
{
    const spvc_reflected_resource *list = NULL;
    size_t count = 0;
    if (spvc_resources_get_resource_list_for_type(resources, type, &list, &count) != SPVC_SUCCESS)
        return;
    for (size_t i = 0; i < count; i++) {
        const char *block = spvc_compiler_get_name(compiler, list[i].base_type_id);
        char name[256];
        snprintf(name, sizeof name, "in_%s", block ? block : "block");
        if (!*spvc_compiler_get_name(compiler, list[i].id))
            spvc_compiler_set_name(compiler, list[i].id, name);
    }
}

static bool set_options(spvc_compiler compiler)
{
    spvc_compiler_options options = NULL;
    return spvc_compiler_create_compiler_options(compiler, &options) == SPVC_SUCCESS &&
           spvc_compiler_options_set_uint(options, SPVC_COMPILER_OPTION_GLSL_VERSION, 450) ==
               SPVC_SUCCESS &&
           spvc_compiler_options_set_bool(options, SPVC_COMPILER_OPTION_GLSL_ES, false) ==
               SPVC_SUCCESS &&
           spvc_compiler_options_set_bool(options,
                                          SPVC_COMPILER_OPTION_GLSL_SUPPORT_NONZERO_BASE_INSTANCE,
                                          false) == SPVC_SUCCESS &&
           spvc_compiler_options_set_bool(options,
                                          SPVC_COMPILER_OPTION_FORCE_ZERO_INITIALIZED_VARIABLES,
                                          true) == SPVC_SUCCESS &&
           spvc_compiler_options_set_bool(
               options, SPVC_COMPILER_OPTION_GLSL_EMIT_PUSH_CONSTANT_AS_UNIFORM_BUFFER, true) ==
               SPVC_SUCCESS &&
           spvc_compiler_install_compiler_options(compiler, options) == SPVC_SUCCESS;
}

/* Whether a vertex shader chooses its layer, which is an extension of which SPIRV-Cross says nothing. */
static bool has_layer(const uint32_t *words, size_t count)
{
    for (size_t at = HEADER; at < count; at += length_of(words + at))
        if ((is(words + at, SpvOpDecorate) && words[at + 2] == SpvDecorationBuiltIn &&
             words[at + 3] == SpvBuiltInLayer) ||
            (is(words + at, SpvOpMemberDecorate) && words[at + 3] == SpvDecorationBuiltIn &&
             words[at + 4] == SpvBuiltInLayer))
            return true;
    return false;
}

static bool cross(spvc_context context, const uint32_t *words, size_t count, const char **glsl)
{
    spvc_parsed_ir ir = NULL;
    spvc_compiler compiler = NULL;
    spvc_resources resources = NULL;
    if (spvc_context_parse_spirv(context, words, count, &ir) != SPVC_SUCCESS ||
        spvc_context_create_compiler(context, SPVC_BACKEND_GLSL, ir,
                                     SPVC_CAPTURE_MODE_TAKE_OWNERSHIP, &compiler) != SPVC_SUCCESS ||
        spvc_compiler_create_shader_resources(compiler, &resources) != SPVC_SUCCESS)
        return false;
    name_blocks(compiler, resources, SPVC_RESOURCE_TYPE_UNIFORM_BUFFER);
    name_blocks(compiler, resources, SPVC_RESOURCE_TYPE_STORAGE_BUFFER);
    if (has_layer(words, count))
        spvc_compiler_require_extension(compiler, "GL_ARB_shader_viewport_layer_array");
    return set_options(compiler) && spvc_compiler_compile(compiler, glsl) == SPVC_SUCCESS;
}

bool spirv_cross(const uint32_t *words, size_t count, struct text *out, char **why)
{
    spvc_context context = NULL;
    const char *glsl = NULL;
    *why = NULL;
    if (spvc_context_create(&context) != SPVC_SUCCESS)
        return false;
    bool good = cross(context, words, count, &glsl);
    if (good)
        text_add(out, "%s", glsl);
    else
        *why = strdup(spvc_context_get_last_error_string(context));
    spvc_context_destroy(context);
    return good && !out->failed;
}

bool spirv_is_module(const void *bytes, size_t size)
{
    uint32_t word;
    if (size < HEADER * sizeof word || size % sizeof word)
        return false;
    memcpy(&word, bytes, sizeof word);
    return word == SpvMagicNumber;
}
