/* See hlsl.h. */
#include "import/hlsl.h"

#include <ctype.h>
#include <spirv/unified1/GLSL.std.450.h>
#include <spirv/unified1/spirv.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "import/reflect.h"
#include "base/text.h"
#include "gen/glsl/initials.h"
#include "gen/model/foreign.h"
#include "gen/model/leaves.h"
#include "gen/model/module.h"
#include "gen/model/spirv_check.h"
#include "gen/read/body_files.h"
#include "gen/spirv/compile.h"

enum { ENTRY_SIZE = 128, REGISTERS_T = 1 << 16 };

/* Entry points as people name them, by stage, in any case and with or without _; main() has the stage that the file's name says. */
static const char *const entries[][9] = {
    [REFLECT_COMPUTE] = {"csmain", "maincs", "cs", "computemain", "computeshaderfunction"},
    [REFLECT_VERTEX] = {"vsmain", "mainvs", "vs", "vertexmain", "vertmain", "vertexshaderfunction"},
    [REFLECT_FRAGMENT] = {"psmain", "mainps", "ps", "pixelmain", "fragmain", "fragmentmain",
                          "pixelshaderfunction", "fsmain", "mainfs"}};

bool hlsl_is(const char *path, const char *text)
{
    static const char *const words[] = {"float2",
                                        "float3",
                                        "float4",
                                        "int4x4",
                                        "double2",
                                        "cbuffer",
                                        "SamplerState",
                                        "StructuredBuffer",
                                        "RWStructuredBuffer",
                                        "RWTexture2D",
                                        "numthreads",
                                        "register",
                                        "RWByteAddressBuffer"};
    const char *ending = strrchr(path, '.');
    bool found = ending && !strcmp(ending, ".hlsl");
    if (!text || strstr(text, "#version"))
        return found;
    for (const char *at = text; (at = strcasestr(at, "SV_")); at++)
        found |= at > text && (at[-1] == ' ' || at[-1] == ':');
    for (size_t i = 0; i < DT_ARRAY_COUNT(words); i++)
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

static bool is_entry(const char *word, size_t length, int stage)
{
    char plain[ENTRY_SIZE];
    size_t count = 0;
    for (size_t i = 0; i < length && count + 1 < sizeof plain; i++)
        if (word[i] != '_')
            plain[count++] = (char)tolower((unsigned char)word[i]);
    plain[count] = '\0';
    for (size_t i = 0; i < DT_ARRAY_COUNT(entries[stage]); i++)
        if (entries[stage][i] && !strcmp(plain, entries[stage][i]))
            return true;
    return false;
}

/* The first word with a parenthesis behind it that is such a name. */
static bool find_entry(const char *text, int stage, char entry[ENTRY_SIZE])
{
    size_t length;
    for (const char *word = text; *word; word += length ? length : 1) {
        for (length = 0; isalnum((unsigned char)word[length]) || word[length] == '_';)
            length++;
        const char *behind = word + length;
        if (length && length < ENTRY_SIZE && behind[strspn(behind, " \t\r\n")] == '(' &&
            is_entry(word, length, stage)) {
            snprintf(entry, ENTRY_SIZE, "%.*s", (int)length, word);
            return true;
        }
    }
    return stage == REFLECT_COMPUTE && find_behind(text, "numthreads", entry);
}

/* The last function of the file, which the others stand before. */
static bool find_last(const char *text, char entry[ENTRY_SIZE])
{
    char *code = strdup(text), *at = code;
    int depth = 0;
    *entry = 0;
    if (code)
        blank_comments(code);
    for (; at && *at; at++) {
        depth += *at == '{' ? 1 : *at == '}' ? -1 : 0;
        if (*at != '(' || depth)
            continue;
        const char *name = at, *end;
        while (name > code && (isalnum((unsigned char)name[-1]) || name[-1] == '_'))
            name--;
        size_t length = (size_t)(at - name);
        while (*at && *at != ')')
            at++;
        end = at + strcspn(at, "{;(");
        if (*end == '{' && length && length < ENTRY_SIZE && strncmp(name, "register", length) != 0)
            snprintf(entry, ENTRY_SIZE, "%.*s", (int)length, name);
        at -= !*at;
    }
    free(code);
    return *entry;
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

/* SPIR-V has no matrices of integers, which glslang writes nevertheless. False: *why has the line of the first in code. */
static bool check_matrices(const struct spirv *m, char **why)
{
    uint32_t line = 0;
    SPIRV_EACH(m, i, m->code, m->count) {
        line = spirv_is(i, SpvOpLine) ? i[2] : line;
        const uint32_t *type = spirv_result(i) ? spirv_type(m, spirv_result(i)) : NULL;
        type = type && spirv_is(type, SpvOpTypePointer) ? spirv_definition(m, type[3]) : type;
        if (!type || !spirv_is(type, SpvOpTypeMatrix) ||
            spirv_is(spirv_scalar(m, spirv_definition(m, type[2])), SpvOpTypeFloat))
            continue;
        *why = format_string("ERROR: HLSL:%u: a matrix of integers or bools, which SPIR-V has not: "
                             "take vectors",
                             line);
        return false;
    }
    return true;
}

/* An instruction; operands of an atomic operation get the type of its result, as where a literal, an int, meets a uint. */
static void put_operands(struct spirv_edit *edit, const uint32_t *i)
{
    bool atomic = spirv_opcode(i) >= SpvOpAtomicExchange && spirv_opcode(i) <= SpvOpAtomicXor;
    uint32_t casts[9] = {0};
    uint32_t first = spirv_length(i) == 9 ? 7 : 6; /* behind two semantics, or one */
    for (uint32_t word = first; atomic && word < spirv_length(i); word++)
        if (spirv_definition(edit->from, i[word])[1] != i[1])
            casts[word] = SPIRV_VALUE(edit, &edit->code, SpvOpBitcast, i[1], i[word]);
    size_t start = edit->code.count;
    spirv_copy(edit, &edit->code, i);
    for (uint32_t word = 6; word < 9 && !edit->failed; word++)
        if (casts[word])
            edit->code.data[start + word] = casts[word];
}

/* Whether a text, also an included one, declares a ByteAddressBuffer of the name. */
static bool is_of_bytes(const struct import_texts *texts, const char *name)
{
    static const char kind[] = "ByteAddressBuffer";
    for (uint32_t i = 0; i < texts->count; i++)
        for (const char *at = texts->list[i].text; (at = strstr(at, kind));) {
            at += strlen(kind);
            const char *found = find_word(at, name);
            if (found && found < at + strcspn(at, ";:(){}\n"))
                return true;
        }
    return false;
}

/* What HLSL means otherwise than glslang's module says: a remainder has the sign of its first operand, which SPIR-V's own have not
 * on every device; a shift takes as many bits as its width has places, ldexp() a float; a ByteAddressBuffer has a length in bytes. */
static void put_meant(struct spirv_edit *edit, const uint32_t *i, const struct import_texts *texts)
{
    uint32_t glsl = spirv_glsl(edit->from);
    struct spirv_words *code = &edit->code;
    const char *buffer = spirv_is(i, SpvOpArrayLength) ? spirv_name(edit->from, i[3]) : NULL;
    if (spirv_is(i, SpvOpFMod)) {
        SPIRV_PUT(edit, code, SpvOpFRem, i[1], i[2], i[3], i[4]);
    } else if (spirv_is(i, SpvOpSMod)) {
        uint32_t ratio = SPIRV_VALUE(edit, code, SpvOpSDiv, i[1], i[3], i[4]);
        uint32_t product = SPIRV_VALUE(edit, code, SpvOpIMul, i[1], ratio, i[4]);
        SPIRV_PUT(edit, code, SpvOpISub, i[1], i[2], i[3], product);
    } else if (spirv_opcode(i) >= SpvOpShiftRightLogical &&
               spirv_opcode(i) <= SpvOpShiftLeftLogical &&
               spirv_scalar(edit->from, spirv_type(edit->from, i[4]))[2] == 32) {
        uint32_t type = spirv_definition(edit->from, i[4])[1];
        uint32_t width = spirv_scalar(edit->from, spirv_definition(edit->from, i[1]))[2];
        uint32_t bits = SPIRV_VALUE(edit, code, SpvOpBitwiseAnd, type, i[4],
                                    spirv_declare_numbers(edit, type, width - 1));
        SPIRV_PUT(edit, code, spirv_opcode(i), i[1], i[2], i[3], bits);
    } else if (buffer && is_of_bytes(texts, buffer)) {
        uint32_t words = SPIRV_VALUE(edit, code, SpvOpArrayLength, i[1], i[3], i[4]);
        SPIRV_PUT(edit, code, SpvOpIMul, i[1], i[2], words, spirv_declare_numbers(edit, i[1], 4));
    } else if (spirv_is(i, SpvOpExtInst) && i[3] == glsl && i[4] == GLSLstd450Ldexp) {
        uint32_t power = SPIRV_VALUE(edit, code, SpvOpExtInst, i[1], glsl, GLSLstd450Exp2, i[6]);
        SPIRV_PUT(edit, code, SpvOpFMul, i[1], i[2], i[5], power);
    } else {
        put_operands(edit, i);
    }
}

/* ---- Semantics ------------------------------------------------------------------------------- */

/* What a variable between two stages is called, with its index, which elements of arrays count on: TEXCOORD1. */
static void name_link(const struct spirv *m, uint32_t variable, const char *semantic,
                      struct hlsl_link *out)
{
    const char *name = spirv_name(m, variable), *element = name ? strrchr(name, '[') : NULL;
    size_t length = strlen(semantic);
    while (length && isdigit((unsigned char)semantic[length - 1]))
        length--;
    unsigned long index = strtoul(semantic + length, NULL, 10);
    index += element ? strtoul(element + 1, NULL, 10) : 0;
    snprintf(out->semantic, sizeof out->semantic, "%.*s%lu", (int)length, semantic, index);
}

static uint32_t *find_location(struct spirv *m, uint32_t variable)
{
    SPIRV_CHANGE(m, i, m->annotations, m->declarations)
        if (spirv_is(i, SpvOpDecorate) && i[1] == variable && i[2] == SpvDecorationLocation)
            return i + 3;
    return NULL;
}

/* Keeps where the vertex shader has an output. */
static bool keep_link(struct hlsl_links *links, const struct hlsl_link *own, char **why)
{
    if (links->count == HLSL_LINKS) {
        *why = format_string("more than %d values go from stage to stage", HLSL_LINKS);
        return false;
    }
    links->list[links->count++] = *own;
    return true;
}

/* Puts an input of the pixel shader where the vertex shader has it, if there is one. */
static bool follow_link(const struct hlsl_links *links, const struct hlsl_link *own,
                        uint32_t *location, char **why)
{
    for (uint32_t i = 0; i < links->count; i++)
        if (!strcmp(links->list[i].semantic, own->semantic)) {
            *location = links->list[i].location;
            return true;
        }
    if (links->count)
        *why = format_string("the pixel shader reads %s, which the vertex shader does not write",
                             own->semantic);
    return !links->count;
}

/* Locations of a draw's values between its stages: glslang gives them in the order of declarations, HLSL means semantics. */
static bool link_stage(struct spirv *m, int stage, struct hlsl_links *links, char **why)
{
    uint32_t class = stage == REFLECT_VERTEX ? SpvStorageClassOutput : SpvStorageClassInput;
    bool good = true;
    SPIRV_EACH(m, i, m->annotations, m->declarations) {
        bool named = spirv_is(i, SpvOpDecorateString) && i[2] == SpvDecorationUserSemantic &&
                     spirv_definition(m, i[1])[3] == class;
        uint32_t *location = named && good ? find_location(m, i[1]) : NULL;
        struct hlsl_link own;
        if (!location)
            continue;
        name_link(m, i[1], (const char *)(i + 3), &own);
        own.location = *location;
        good = stage == REFLECT_VERTEX ? keep_link(links, &own, why)
                                       : follow_link(links, &own, location, why);
    }
    return good;
}

/* Buffers of registers t, which are only read, and u become of one class. Those of t get numbers behind all others. */
static void part_registers(struct spirv *m)
{
    SPIRV_CHANGE(m, i, m->annotations, m->declarations) {
        const uint32_t *variable = spirv_is(i, SpvOpDecorate) && i[2] == SpvDecorationBinding
                                       ? spirv_definition(m, i[1])
                                       : NULL;
        uint32_t type = variable ? spirv_element_type(m, spirv_pointee(m, variable)) : 0;
        if (type && spirv_is(spirv_definition(m, type), SpvOpTypeStruct) &&
            spirv_member_decoration(m, type, 0, SpvDecorationNonWritable) != UINT32_MAX)
            i[3] += REGISTERS_T;
    }
}

/* The counter of a buffer, whose place glslang leaves out where a function takes the buffer. */
static void put_offsets(struct spirv_edit *edit)
{
    const struct spirv *m = edit->from;
    SPIRV_EACH(m, i, m->annotations, edit->failed ? 0 : m->declarations) {
        bool block = spirv_is(i, SpvOpDecorate) &&
                     (i[2] == SpvDecorationBufferBlock || i[2] == SpvDecorationBlock);
        if (block && spirv_length(spirv_definition(m, i[1])) == 3 &&
            spirv_member_decoration(m, i[1], 0, SpvDecorationOffset) == UINT32_MAX)
            SPIRV_PUT(edit, &edit->annotations, SpvOpMemberDecorate, i[1], 0, SpvDecorationOffset,
                      0);
    }
}

/* ---- Demotion -------------------------------------------------------------------------------- */

enum { MOST_CONSTRUCTS = 256 };

/* Where an invocation goes on that HLSL discards: behind the innermost construct that it is in; 0: to the function's end. */
struct constructs {
    uint32_t ends[MOST_CONSTRUCTS], count, type;
};

static void follow_constructs(struct constructs *constructs, const uint32_t *i)
{
    if (spirv_is(i, SpvOpFunction))
        *constructs = (struct constructs){.type = i[1]};
    if ((spirv_is(i, SpvOpSelectionMerge) || spirv_is(i, SpvOpLoopMerge)) &&
        constructs->count < MOST_CONSTRUCTS)
        constructs->ends[constructs->count++] = i[1];
    while (spirv_is(i, SpvOpLabel) && constructs->count &&
           constructs->ends[constructs->count - 1] == i[1])
        constructs->count--;
}

/* HLSL's discard and clip() leave a helper, whose derivatives count; glslang ends the invocation. */
static void put_demotion(struct spirv_edit *edit, const struct constructs *constructs)
{
    const struct spirv *m = edit->from;
    struct spirv_words *code = &edit->code;
    uint32_t end = constructs->count ? constructs->ends[constructs->count - 1] : 0;
    const uint32_t *first = end ? spirv_definition(m, end) + 2 : NULL;
    spirv_put(edit, code, SpvOpDemoteToHelperInvocation, NULL, 0);
    if (first && !spirv_is(first, SpvOpUnreachable) && !spirv_is(first, SpvOpPhi))
        SPIRV_PUT(edit, code, SpvOpBranch, end);
    else if (spirv_is(spirv_definition(m, constructs->type), SpvOpTypeVoid))
        spirv_put(edit, code, SpvOpReturn, NULL, 0);
    else
        SPIRV_PUT(edit, code, SpvOpReturnValue,
                  spirv_declare(edit, SpvOpConstantNull, constructs->type, NULL, 0));
}

/* Says that the module demotes. */
static void put_capability(struct spirv_edit *edit)
{
    static const char name[] = "SPV_EXT_demote_to_helper_invocation";
    uint32_t words[sizeof name / 4 + 1] = {0};
    memcpy(words, name, sizeof name);
    edit->front.count = SPIRV_HEADER;
    SPIRV_PUT(edit, &edit->front, SpvOpCapability, SpvCapabilityDemoteToHelperInvocation);
    SPIRV_EACH(edit->from, i, SPIRV_HEADER, edit->failed ? 0 : edit->from->annotations) {
        if (spirv_is(i, SpvOpExtInstImport))
            spirv_put(edit, &edit->front, SpvOpExtension, words, sizeof name / 4);
        spirv_copy(edit, &edit->front, i);
    }
}

/* ---------------------------------------------------------------------------------------------- */

static uint32_t *put_all_meant(const uint32_t *words, size_t *count,
                               const struct import_texts *texts, int stage,
                               struct hlsl_links *links, char **why)
{
    struct spirv module;
    struct spirv_edit edit;
    if (!words || !spirv_open(&module, words, *count))
        return NULL;
    if (!check_matrices(&module, why) || !link_stage(&module, stage, links, why)) {
        spirv_free(&module);
        return NULL;
    }
    part_registers(&module);
    spirv_edit_begin(&edit, &module);
    spirv_edit_annotations(&edit);
    put_offsets(&edit);
    bool demotes = false;
    SPIRV_EACH(&module, i, module.code, module.count)
        demotes |= spirv_is(i, SpvOpKill);
    demotes = demotes && stage == REFLECT_FRAGMENT && spirv_can_demote(&module);
    struct constructs constructs = {0};
    if (demotes)
        put_capability(&edit);
    SPIRV_EACH(&module, i, module.code, edit.failed ? 0 : module.count) {
        follow_constructs(&constructs, i);
        if (demotes && spirv_is(i, SpvOpKill))
            put_demotion(&edit, &constructs);
        else
            put_meant(&edit, i, texts);
    }
    if (spirv_edit_end(&edit, &module))
        return spirv_take(&module, count);
    spirv_free(&module);
    return NULL;
}

/* Functions of HLSL 2021. A number without a point may stand beside floats. */
static const char of_2021[] =
    "#define SELECT(B, T, A, C) T select(B c, A a, C b) { return c ? a : b; }\n"
    "#define EACH(B, F, I, U) SELECT(B, F, F, F) SELECT(B, F, F, int) SELECT(B, F, int, F) "
    "SELECT(B, I, I, I) SELECT(B, U, U, U) SELECT(B, B, B, B) "
    "B and(B a, B b) { return a && b; } B or(B a, B b) { return a || b; }\n"
    "EACH(bool, float, int, uint) EACH(bool2, float2, int2, uint2)\n"
    "EACH(bool3, float3, int3, uint3) EACH(bool4, float4, int4, uint4)\n"
    "#undef SELECT\n#undef EACH\n";

/* entry: gets the name of the entry point. */
static struct glslang_job job_of(const struct import_texts *texts, const char *name, int stage,
                                 char entry[ENTRY_SIZE])
{
    const char *text = texts->list[0].text, *own = find_word(text, "main");
    bool named = find_entry(text, stage, entry) || (!own && find_last(text, entry));
    return (struct glslang_job){.code = text,
                                .stage = stage,
                                .minor = 3,
                                .lines = true,
                                .hlsl = named ? entry : "main",
                                .name = name,
                                .more = texts->of_2021 ? of_2021 : NULL,
                                .include = texts_include,
                                .user = texts};
}

void hlsl_initials(const struct import_texts *texts, const char *name, int stage,
                   struct reflection *reflection)
{
    char entry[ENTRY_SIZE];
    struct glslang_job job = job_of(texts, name, stage, entry);
    glsl_initials(&job, reflect_initial, reflection);
}

/* With the functions of 2021 where they are missing. Where an author has some of them, the first messages count. */
static uint32_t *compile_hlsl(struct import_texts *texts, const char *name, int stage,
                              size_t *count, char **why)
{
    char entry[ENTRY_SIZE], *first = NULL;
    struct glslang_job job = job_of(texts, name, stage, entry);
    uint32_t *words = spirv_init(true) ? glslang_compile(&job, count, why) : NULL;
    if (words || !*why || !strstr(*why, "no matching overloaded function"))
        return words;
    first = *why;
    job.more = of_2021;
    words = glslang_compile(&job, count, why);
    texts->of_2021 = words;
    bool own = !words && (!*why || strstr(*why, "already has a body"));
    free(own ? *why : first);
    *why = own ? first : *why;
    return words;
}

uint32_t *hlsl_compile(struct import_texts *texts, const char *name, int stage,
                       struct hlsl_links *links, size_t *count, char **why)
{
    uint32_t *words = compile_hlsl(texts, name, stage, count, why);
    uint32_t *meant = put_all_meant(words, count, texts, stage, links, why);
    uint32_t *legal = meant ? spirv_optimize(meant, count, SPIRV_FLATTEN | SPIRV_LEGALIZE) : NULL;
    char *said = NULL;
    if (meant && !legal && !*why && !spirv_check(meant, *count, &said))
        *why = format_string("glslang makes no valid module of this HLSL: %s", said ? said : "");
    free(said);
    free(words);
    free(meant);
    if (!legal || spirv_check(legal, *count, why))
        return legal;
    free(legal);
    return NULL;
}
