/* See hlsl.h. */
#include "import/hlsl.h"

#include <ctype.h>
#include <spirv/unified1/GLSL.std.450.h>
#include <spirv/unified1/spirv.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "import/reflect.h"
#include "gen/glsl/glslang.h"
#include "gen/model/module.h"
#include "gen/model/spirv_check.h"
#include "gen/read/body_files.h"
#include "gen/spirv/compile.h"

enum { ENTRY_SIZE = 128 };

/* Entry points as people name them, by stage; main() has the stage that the file's name says. */
static const char *const entries[][6] = {
    [REFLECT_COMPUTE] = {"CSMain", "csMain", "cs_main", "mainCS", "MainCS", "CS"},
    [REFLECT_VERTEX] = {"VSMain", "vsMain", "vs_main", "mainVS", "MainVS", "VS"},
    [REFLECT_FRAGMENT] = {"PSMain", "psMain", "ps_main", "mainPS", "MainPS", "PS"}};

bool hlsl_is(const char *path, const char *text)
{
    static const char *const words[] = {"float4", "cbuffer", "SamplerState", "numthreads",
                                        "RWTexture2D"};
    const char *ending = strrchr(path, '.');
    bool found = ending && !strcmp(ending, ".hlsl");
    for (size_t i = 0; text && !strstr(text, "#version") && i < DT_ARRAY_COUNT(words); i++)
        found |= find_word(text, words[i]) != NULL;
    return found;
}

/* The function behind an attribute, as [numthreads(8, 8, 1)]. */
static bool find_behind(const char *text, const char *attribute, char entry[ENTRY_SIZE])
{
    const char *at = find_word(text, attribute), *open = at ? strchr(at, ']') : NULL;
    while (open && open[1 + strspn(open + 1, " \t\r\n")] == '[')
        open = strchr(open + 1, ']');
    open = open ? strchr(open, '(') : NULL;
    size_t length = 0;
    while (open && (isalnum((unsigned char)open[-1]) || open[-1] == '_'))
        open--, length++;
    if (length)
        snprintf(entry, ENTRY_SIZE, "%.*s", (int)length, open);
    return length && length < ENTRY_SIZE;
}

static bool find_entry(const char *text, int stage, char entry[ENTRY_SIZE])
{
    for (size_t i = 0; i < DT_ARRAY_COUNT(entries[stage]); i++) {
        const char *at = find_word(text, entries[stage][i]);
        const char *behind = at ? at + strlen(entries[stage][i]) : "";
        snprintf(entry, ENTRY_SIZE, "%s", entries[stage][i]);
        if (behind[strspn(behind, " \t\r\n")] == '(')
            return true;
    }
    return stage == REFLECT_COMPUTE && find_behind(text, "numthreads", entry);
}

unsigned hlsl_stages(const char *text)
{
    unsigned stages = 0;
    char entry[ENTRY_SIZE];
    for (int stage = REFLECT_COMPUTE; stage <= REFLECT_FRAGMENT; stage++)
        stages |= (find_entry(text, stage, entry) ? 1u : 0) << stage;
    if (!stages && strcasestr(text, "SV_Target")) /* of main() */
        return 1u << REFLECT_FRAGMENT;
    return !stages && strcasestr(text, "SV_Position") ? 1u << REFLECT_VERTEX : stages;
}

/* What HLSL means otherwise than glslang's module says: a remainder has the sign of its first operand, ldexp() takes a float. */
static void put_meant(struct spirv_edit *edit, const uint32_t *i)
{
    uint32_t glsl = spirv_glsl(edit->from);
    struct spirv_words *code = &edit->code;
    if (spirv_is(i, SpvOpFMod) || spirv_is(i, SpvOpFRem)) {
        uint32_t quotient = SPIRV_VALUE(edit, code, SpvOpFDiv, i[1], i[3], i[4]);
        uint32_t whole =
            SPIRV_VALUE(edit, code, SpvOpExtInst, i[1], glsl, GLSLstd450Trunc, quotient);
        uint32_t product = SPIRV_VALUE(edit, code, SpvOpFMul, i[1], i[4], whole);
        SPIRV_PUT(edit, code, SpvOpFSub, i[1], i[2], i[3], product);
    } else if (spirv_is(i, SpvOpSMod)) {
        SPIRV_PUT(edit, code, SpvOpSRem, i[1], i[2], i[3], i[4]);
    } else if (spirv_is(i, SpvOpExtInst) && i[3] == glsl && i[4] == GLSLstd450Ldexp) {
        uint32_t power = SPIRV_VALUE(edit, code, SpvOpExtInst, i[1], glsl, GLSLstd450Exp2, i[6]);
        SPIRV_PUT(edit, code, SpvOpFMul, i[1], i[2], i[5], power);
    } else {
        spirv_copy(edit, code, i);
    }
}

static uint32_t *put_all_meant(const uint32_t *words, size_t *count)
{
    struct spirv module;
    struct spirv_edit edit;
    if (!words || !spirv_open(&module, words, *count))
        return NULL;
    spirv_edit_begin(&edit, &module);
    spirv_edit_annotations(&edit);
    SPIRV_EACH(&module, at, module.code, edit.failed ? 0 : module.count)
    put_meant(&edit, module.words + at);
    if (spirv_edit_end(&edit, &module))
        return spirv_take(&module, count);
    spirv_free(&module);
    return NULL;
}

uint32_t *hlsl_compile(const struct import_texts *texts, const char *name, int stage, size_t *count,
                       char **why)
{
    char entry[ENTRY_SIZE];
    bool named = find_entry(texts->list[0].text, stage, entry);
    const struct glslang_job job = {.code = texts->list[0].text,
                                    .stage = stage,
                                    .minor = 3,
                                    .lines = true,
                                    .hlsl = named ? entry : "main",
                                    .name = name,
                                    .include = texts_include,
                                    .user = texts};
    uint32_t *words = spirv_init() ? glslang_compile(&job, count, why) : NULL;
    uint32_t *meant = put_all_meant(words, count);
    uint32_t *legal = meant ? spirv_optimize(meant, count, SPIRV_LEGALIZE) : NULL;
    if (words && !legal)
        spirv_check(words, *count, why);
    free(words);
    free(meant);
    if (!legal || spirv_check(legal, *count, why))
        return legal;
    free(legal);
    return NULL;
}
