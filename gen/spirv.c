/* GLSL to SPIR-V with glslang, then spirv-val. Exact mode expands matrix products and
 * puts NoContraction on all float arithmetic. For CPU targets long loops stay loops. Called by
 * shaders.c. Messages of glslang are reported at the line of the original file. */
#include "diag.h"
#include "expr.h"
#include "glslang.h"
#include "plan.h"
#include "prove.h"
#include "spirv.h"
#include "stages.h"

#include <ctype.h>
#include <glslang/build_info.h>
#include <spirv-tools/libspirv.h>
#include <spirv/unified1/GLSL.std.450.h>
#define SPV_ENABLE_UTILITY_CODE /* SpvHasResultAndType */
#include <spirv/unified1/spirv.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Start ----------------------------------------------------------------------------------- */

/* glslang keeps its tables until the process ends. */
bool spirv_init(void)
{
    static atomic_bool started;
    if (!started)
        started = glslang_start();
    return started;
}

#define WORD(text)      #text
#define DOTTED(a, b, c) WORD(a) "." WORD(b) "." WORD(c)

const char *spirv_tools(void)
{
    static char tools[256];
    snprintf(tools, sizeof tools, "glslang %s, %s",
             DOTTED(GLSLANG_VERSION_MAJOR, GLSLANG_VERSION_MINOR, GLSLANG_VERSION_PATCH),
             spvSoftwareVersionString());
    return tools;
}

/* ---- Messages -------------------------------------------------------------------------------- */

static bool is_word(char c)
{
    return isalnum((unsigned char)c) || c == '_';
}

/* The line of the source and its length; NULL when it has fewer lines. */
static const char *line_of(const struct loc *loc, size_t *length)
{
    const char *at = loc->source->text, *end = at + loc->source->length;
    for (int line = 1; line < loc->line && at; line++) {
        at = memchr(at, '\n', (size_t)(end - at));
        at = at ? at + 1 : NULL;
    }
    const char *newline = at ? memchr(at, '\n', (size_t)(end - at)) : NULL;
    *length = at ? (size_t)((newline ? newline : end) - at) : 0;
    return at;
}

/* Sets column and length of `loc` to `word` in its line; no change when the line has no `word`. */
static void find_in_line(struct loc *loc, const char *word, size_t length)
{
    size_t width;
    const char *at = line_of(loc, &width);
    if (!at || !length)
        return;
    for (size_t i = 0; i + length <= width; i++) {
        bool inside = is_word(word[0]) && ((i && is_word(at[i - 1])) ||
                                           (i + length < width && is_word(at[i + length])));
        if (!inside && !memcmp(at + i, word, length)) {
            loc->column = (int)i + 1;
            loc->length = (int)length;
            return;
        }
    }
}

static void note_uniform(const struct loc *error, const char *name, struct loc declared,
                         struct diag *diag)
{
    struct loc used = *error;
    used.length = 0;
    find_in_line(&used, name, strlen(name));
    if (used.length)
        diag_note(diag, declared,
                  "`%s` is in a uniform block, so it is not a constant expression in shaders",
                  name);
}

/* After an error about a constant: notes the uniform names in its line, which are not constant. */
static void note_uniforms(const struct pipeline *pipeline, const struct loc *error,
                          struct diag *diag)
{
    for (uint32_t i = 0; i < pipeline->param_count; i++)
        if (pipeline->params[i].uniform)
            note_uniform(error, pipeline->params[i].name, pipeline->params[i].loc, diag);
    for (uint32_t i = 0; i < pipeline->constant_count; i++)
        if (pipeline->constants[i].folds && !constant_is_literal(&pipeline->constants[i]))
            note_uniform(error, pipeline->constants[i].name, pipeline->constants[i].loc, diag);
}

/* Replaces glslang's error about a subgroup operation where a pass cannot have one. */
static bool report_subgroups(const struct pipeline *pipeline, const struct pass *pass,
                             struct loc loc, const char *name, struct diag *diag)
{
    static const char *const starts[] = {"subgroup", "gl_Subgroup", "gl_NumSubgroups"};
    size_t i = 0;
    while (i < DT_ARRAY_COUNT(starts) && strncmp(name, starts[i], strlen(starts[i])))
        i++;
    if (i == DT_ARRAY_COUNT(starts) || (pipeline->fast && pass->kind == PASS_DISPATCH))
        return false;
    if (!strncmp(name, "subgroup op'", 12)) /* another message has the name */
        return true;
    int length = (int)strcspn(name, "'");
    diag_error(diag, loc,
               pipeline->fast
                   ? "`%.*s` in a draw: only a dispatch can have subgroup operations"
                   : "`%.*s` needs `exactness: fast`: the size of subgroups, and the order in "
                     "which they reduce, differ from device to device; use shared memory",
               length, name);
    return true;
}

/* "ERROR: 1:12: 'name' : text": file and line as #line gave them. */
static void report_line(const struct model *model, const struct pass *pass, const char *line,
                        size_t length, struct diag *diag)
{
    static const char prefix[] = "ERROR: ";
    char *end;
    if (length < sizeof prefix || memcmp(line, prefix, sizeof prefix - 1) ||
        !isdigit((unsigned char)line[sizeof prefix - 1]))
        return;
    unsigned long number = strtoul(line + sizeof prefix - 1, &end, 10);
    if (*end != ':') /* "ERROR: 2 compilation errors" */
        return;
    unsigned long row = strtoul(end + 1, &end, 10);
    const char *text = end + strspn(end, ": "), *stop = line + length;
    if (text >= stop)
        return;
    if (number < 1 || number > model->glsl_source_count) {
        diag_error(diag, pass->shader_loc, "pass %s, line %lu of the generated GLSL: %.*s",
                   pass->name, row, (int)(stop - text), text);
        return;
    }
    struct loc loc = {model->glsl_sources[number - 1], (int)row, 1, 1};
    static const char exact[] = "'exact_"; /* a prefix that glsl_exact.c added */
    size_t added = (size_t)(stop - text) > sizeof exact && !memcmp(text, exact, sizeof exact - 1)
                       ? sizeof exact - 2
                       : 0;
    const char *close = *text == '\'' ? memchr(text + 1, '\'', (size_t)(stop - text - 1)) : NULL;
    if (added && !strncmp(text + 1 + added, "divide'", 7))
        find_in_line(&loc, "/", 1);
    else if (close)
        find_in_line(&loc, text + 1 + added, (size_t)(close - text - 1) - added);
    if (close && report_subgroups(&model->pipeline, pass, loc, text + 1, diag))
        return;
    if (close == text + 1) /* '' : text */
        text = close + 1 + strspn(close + 1, ": ");
    diag_error(diag, loc, "%.*s", (int)(stop - text), text);
    const char *asked = strstr(text, "constant");
    if (asked && asked < stop)
        note_uniforms(&model->pipeline, &loc, diag);
}

static void report_log(const struct model *model, const struct pass *pass, const char *log,
                       struct diag *diag)
{
    unsigned before = diag_error_count(diag);
    for (const char *line = log; *line;) {
        size_t length = strcspn(line, "\n");
        report_line(model, pass, line, length, diag);
        line += length + (line[length] == '\n');
    }
    if (diag_error_count(diag) == before)
        diag_error(diag, pass->shader_loc, "pass %s does not compile: %s", pass->name, log);
}

/* ---- Exactness ------------------------------------------------------------------------------- */

static bool is_float_arithmetic(uint32_t opcode)
{
    switch (opcode) {
    case SpvOpFNegate:
    case SpvOpFAdd:
    case SpvOpFSub:
    case SpvOpFMul:
    case SpvOpFDiv:
    case SpvOpFRem:
    case SpvOpFMod:
    case SpvOpVectorTimesScalar:
    case SpvOpMatrixTimesScalar:
    case SpvOpVectorTimesMatrix:
    case SpvOpMatrixTimesVector:
    case SpvOpMatrixTimesMatrix:
    case SpvOpOuterProduct:
    case SpvOpDot:
        return true;
    default:
        return false;
    }
}

/* Decorations stand before the first type, constant or variable. */
static bool is_declaration(uint32_t opcode)
{
    return (opcode >= SpvOpTypeVoid && opcode <= SpvOpTypeForwardPointer) ||
           (opcode >= SpvOpConstantTrue && opcode <= SpvOpSpecConstantOp) ||
           opcode == SpvOpVariable || opcode == SpvOpUndef;
}

/* The external definition of the header's inline function. */
extern void SpvHasResultAndType(SpvOp opcode, bool *hasResult, bool *hasResultType);

bool spirv_ends_block(const uint32_t *instruction)
{
    uint32_t opcode = *instruction & 0xffff;
    return (opcode >= SpvOpBranch && opcode <= SpvOpUnreachable) ||
           opcode == SpvOpTerminateInvocation;
}

/* Of the debug instructions: names and sources up to OpLine, and two later ones. */
static bool is_debug(uint32_t opcode)
{
    return (opcode >= SpvOpSourceContinued && opcode <= SpvOpLine) || opcode == SpvOpNoLine ||
           opcode == SpvOpModuleProcessed;
}

size_t spirv_strip(uint32_t *words, size_t count)
{
    size_t kept = count < SPIRV_HEADER ? count : SPIRV_HEADER;
    for (size_t at = SPIRV_HEADER, length; at < count; at += length) {
        length = words[at] >> 16;
        if (!is_debug(words[at] & 0xffff)) {
            memmove(words + kept, words + at, length * sizeof *words);
            kept += length;
        }
    }
    return kept;
}

size_t spirv_for_opengl(uint32_t *words, size_t count)
{
    static const uint32_t builtins[][2] = {{SpvBuiltInVertexIndex, SpvBuiltInVertexId},
                                           {SpvBuiltInInstanceIndex, SpvBuiltInInstanceId}};
    size_t kept = SPIRV_HEADER;
    for (size_t at = SPIRV_HEADER, length; at < count; at += length) {
        length = words[at] >> 16;
        bool decorates = spirv_is(words + at, SpvOpDecorate);
        if (decorates && words[at + 2] == SpvDecorationDescriptorSet)
            continue;
        for (size_t i = 0; i < DT_ARRAY_COUNT(builtins); i++)
            if (decorates && words[at + 2] == SpvDecorationBuiltIn &&
                words[at + 3] == builtins[i][0])
                words[at + 3] = builtins[i][1];
        if (spirv_is(words + at, SpvOpExecutionMode) &&
            words[at + 2] == SpvExecutionModeOriginUpperLeft)
            words[at + 2] = SpvExecutionModeOriginLowerLeft;
        memmove(words + kept, words + at, length * sizeof *words);
        kept += length;
    }
    return kept;
}

uint32_t spirv_result(const uint32_t *instruction)
{
    bool has_result, has_type;
    SpvHasResultAndType((SpvOp)(*instruction & 0xffff), &has_result, &has_type);
    return has_result ? instruction[has_type ? 2 : 1] : 0;
}

uint32_t *spirv_definitions(const uint32_t *words, size_t count)
{
    uint32_t *offsets = calloc(words[3], sizeof *offsets);
    for (size_t at = SPIRV_HEADER; offsets && at < count; at += words[at] >> 16) {
        uint32_t result = spirv_result(words + at);
        if (result)
            offsets[result] = (uint32_t)at;
    }
    return offsets;
}

enum { MAX_PRODUCT = 4 * 5 + 4 * 66 + 7 }; /* words of the longest product, two mat4 */

struct expansion {
    const uint32_t *words;
    const uint32_t *definitions;
    uint32_t *out;
    size_t length;
    uint32_t bound;
};

static size_t put(uint32_t *out, size_t length, SpvOp opcode, const uint32_t *operands,
                  uint32_t count)
{
    out[length] = (count + 1) << 16 | opcode;
    memcpy(out + length + 1, operands, count * sizeof *out);
    return length + count + 1;
}

/* An instruction with two operands. Its result is `id`, or a new id for 0. */
static uint32_t put_new(struct expansion *to, SpvOp opcode, uint32_t type, uint32_t id, uint32_t a,
                        uint32_t b)
{
    uint32_t result = id ? id : to->bound++;
    to->length = put(to->out, to->length, opcode, (uint32_t[]){type, result, a, b}, 4);
    return result;
}

/* The instruction that declares the type of an id. Vectors and matrices: [2] is the type of a
 * component or column, [3] their number. */
static const uint32_t *type_of(const struct expansion *to, uint32_t id)
{
    return to->words + to->definitions[to->words[to->definitions[id] + 1]];
}

/* columns[0] * v.x + columns[1] * v.y + ..., in this order. v has `size` components of `scalar`. */
static uint32_t put_sum(struct expansion *to, uint32_t type, uint32_t id, const uint32_t *columns,
                        uint32_t size, uint32_t scalar, uint32_t vector)
{
    uint32_t sum = 0;
    for (uint32_t i = 0; i < size; i++) {
        uint32_t factor = put_new(to, SpvOpCompositeExtract, scalar, 0, vector, i);
        uint32_t term = put_new(to, SpvOpVectorTimesScalar, type, 0, columns[i], factor);
        sum = i ? put_new(to, SpvOpFAdd, type, i + 1 == size ? id : 0, sum, term) : term;
    }
    return sum;
}

/* v.x * column.x + v.y * column.y + ..., in this order. */
static uint32_t put_dot(struct expansion *to, const uint32_t *vector_type, uint32_t vector,
                        uint32_t column)
{
    uint32_t sum = 0, type = vector_type[2];
    uint32_t terms = put_new(to, SpvOpFMul, vector_type[1], 0, vector, column);
    for (uint32_t i = 0; i < vector_type[3]; i++) {
        uint32_t term = put_new(to, SpvOpCompositeExtract, type, 0, terms, i);
        sum = i ? put_new(to, SpvOpFAdd, type, 0, sum, term) : term;
    }
    return sum;
}

/* Expands a product with a matrix. Otherwise each driver chooses its own order of the terms, even
 * with NoContraction. */
static void put_product(struct expansion *to, const uint32_t *product)
{
    SpvOp opcode = (SpvOp)(product[0] & 0xffff);
    uint32_t type = product[1], id = product[2], left = product[3], right = product[4];
    uint32_t columns[4] = {0}, parts[6] = {type, id};
    uint32_t matrix = opcode == SpvOpVectorTimesMatrix ? right : left;
    const uint32_t *matrix_type = type_of(to, matrix), *right_type = type_of(to, right);
    for (uint32_t i = 0; i < matrix_type[3]; i++)
        columns[i] = put_new(to, SpvOpCompositeExtract, matrix_type[2], 0, matrix, i);
    if (opcode == SpvOpMatrixTimesVector) {
        put_sum(to, type, id, columns, matrix_type[3], right_type[2], right);
        return;
    }
    if (opcode == SpvOpMatrixTimesMatrix)
        for (uint32_t i = 0; i < right_type[3]; i++) {
            const uint32_t *column_type = to->words + to->definitions[right_type[2]];
            uint32_t column = put_new(to, SpvOpCompositeExtract, right_type[2], 0, right, i);
            parts[2 + i] =
                put_sum(to, matrix_type[2], 0, columns, matrix_type[3], column_type[2], column);
        }
    else
        for (uint32_t i = 0; i < matrix_type[3]; i++)
            parts[2 + i] = put_dot(to, type_of(to, left), left, columns[i]);
    to->length = put(to->out, to->length, SpvOpCompositeConstruct, parts, 2 + right_type[3]);
}

static bool is_product(uint32_t opcode)
{
    return opcode == SpvOpMatrixTimesVector || opcode == SpvOpVectorTimesMatrix ||
           opcode == SpvOpMatrixTimesMatrix;
}

/* Whether the instruction is NoContraction on a product, from `precise`. It is dropped with the
 * product; decorate() marks the parts. */
static bool marks_product(const struct expansion *to, const uint32_t *instruction)
{
    return (*instruction & 0xffff) == SpvOpDecorate &&
           instruction[2] == SpvDecorationNoContraction &&
           is_product(to->words[to->definitions[instruction[1]]] & 0xffff);
}

/* New words with expanded products of matrices; NULL when out of memory. */
static uint32_t *expand_products(const uint32_t *words, size_t count, size_t *new_count)
{
    size_t products = 0;
    for (size_t at = SPIRV_HEADER; at < count; at += words[at] >> 16)
        products += is_product(words[at] & 0xffff);
    uint32_t *offsets = spirv_definitions(words, count);
    uint32_t *out = malloc((count + MAX_PRODUCT * products) * sizeof *out);
    struct expansion to = {words, offsets, out, 5, words[3]};
    if (offsets && out) {
        memcpy(out, words, 5 * sizeof *out);
        for (size_t at = SPIRV_HEADER; at < count; at += words[at] >> 16) {
            if (is_product(words[at] & 0xffff)) {
                put_product(&to, words + at);
            } else if (!marks_product(&to, words + at)) {
                memcpy(out + to.length, words + at, (words[at] >> 16) * sizeof *out);
                to.length += words[at] >> 16;
            }
        }
        out[3] = to.bound;
        *new_count = to.length;
    } else {
        free(out);
        out = NULL;
    }
    free(offsets);
    return out;
}

/* Returns the position of the first declaration, after all decorations. Counts float arithmetic,
 * and marks results that `precise` has decorated. */
static size_t survey(const uint32_t *words, size_t count, bool *decorated, size_t *results)
{
    size_t insert = 0;
    for (size_t at = SPIRV_HEADER; at < count; at += words[at] >> 16) {
        uint32_t opcode = words[at] & 0xffff;
        if (!insert && is_declaration(opcode))
            insert = at;
        if (opcode == SpvOpDecorate && words[at + 2] == SpvDecorationNoContraction)
            decorated[words[at + 1]] = true;
        *results += is_float_arithmetic(opcode);
    }
    return insert;
}

/* New words in which every result of float arithmetic has NoContraction; NULL when out of
 * memory. */
static uint32_t *decorate(const uint32_t *words, size_t count, size_t *new_count)
{
    size_t results = 0;
    bool *decorated = calloc(words[3], sizeof *decorated); /* by id */
    if (!decorated)
        return NULL;
    size_t insert = survey(words, count, decorated, &results), length = insert;
    uint32_t *out = malloc((count + 3 * results) * sizeof *out);
    if (out) {
        memcpy(out, words, insert * sizeof *out);
        for (size_t at = insert; at < count; at += words[at] >> 16)
            if (is_float_arithmetic(words[at] & 0xffff) && !decorated[words[at + 2]])
                length = put(out, length, SpvOpDecorate,
                             (uint32_t[]){words[at + 2], SpvDecorationNoContraction}, 2);
        memcpy(out + length, words + insert, (count - insert) * sizeof *out);
        *new_count = length + count - insert;
    }
    free(decorated);
    return out;
}

static uint32_t *make_exact(const uint32_t *words, size_t count, size_t *new_count)
{
    size_t expanded_count = 0;
    uint32_t *expanded = expand_products(words, count, &expanded_count);
    uint32_t *exact = expanded ? decorate(expanded, expanded_count, new_count) : NULL;
    free(expanded);
    return exact;
}

/* ---- Compiling ------------------------------------------------------------------------------- */

/* Takes over `words`. */
static bool take_words(const struct model *model, uint32_t *words, size_t count,
                       struct shader *shader)
{
    if (model->pipeline.fast) {
        shader->words = words;
        shader->word_count = count;
    } else {
        shader->words = make_exact(words, count, &shader->word_count);
        free(words);
    }
    return shader->words &&
           (model->pipeline.gpu || spirv_keep_loops(shader->words, shader->word_count));
}

/* By SPIR-V's rules: those of Vulkan take half as long again, and tests/golden_test.sh holds the
 * modules to both APIs. Names for messages take most of the time, so only an invalid module gets
 * them. */
static bool validate(const struct pass *pass, const struct shader *shader, struct diag *diag)
{
    spv_context context = spvContextCreate(SPV_ENV_UNIVERSAL_1_6);
    spv_validator_options options = spvValidatorOptionsCreate();
    spvValidatorOptionsSetFriendlyNames(options, false);
    spv_const_binary_t binary = {shader->words, shader->word_count};
    bool valid = spvValidateWithOptions(context, options, &binary, NULL) == SPV_SUCCESS;
    if (!valid && diag) {
        spv_diagnostic diagnostic = NULL;
        spvValidateBinary(context, shader->words, shader->word_count, &diagnostic);
        diag_error(diag, pass->shader_loc, "pass %s: spirv-val says: %s", pass->name,
                   diagnostic && diagnostic->error ? diagnostic->error : "invalid module");
        spvDiagnosticDestroy(diagnostic);
    }
    spvValidatorOptionsDestroy(options);
    spvContextDestroy(context);
    return valid;
}

/* OpenGL takes SPIR-V 1.0, and by GL_KHR_shader_subgroup 1.3, which brought subgroup operations. In
 * 1.5 a vertex shader's layer is a capability of its own, as some devices have it. */
static int minor_version(const struct shader *shader)
{
    const char *code = shader_code(shader)->data;
    if (shader->own && !shader->code.length)
        return 5; /* Vulkan's own */
    return strstr(code, "\n#extension GL_KHR_shader_subgroup_basic") ? 3 : 0;
}

/* `lines`: with OpLine, which makes no valid module of all that follows. */
static bool compile(const struct model *model, const struct pass *pass, bool lines,
                    struct shader *shader, struct diag *diag)
{
    const struct glslang_job job = {shader_code(shader)->data, shader->stage, minor_version(shader),
                                    lines};
    char *log = NULL;
    size_t count;
    uint32_t *words = glslang_compile(&job, &count, &log);
    if (!words && diag)
        report_log(model, pass, log ? log : "out of memory", diag);
    free(log);
    return words && take_words(model, words, count, shader);
}

bool spirv_compile(const struct model *model, const struct pass *pass, enum backend backend,
                   struct shader *shader, struct diag *diag)
{
    if (!compile(model, pass, false, shader, diag) || !validate(pass, shader, diag))
        return false;
    if (backend == BACKEND_GL)
        shader->word_count = spirv_for_opengl(shader->words, shader->word_count);
    return true;
}

/* ---- Proof ----------------------------------------------------------------------------------- */

struct proving {
    const struct model *model;
    const struct pass *pass;
    struct diag *diag;
    bool numbers;  /* a scene draw leaves numbers and depth: the rasterizer decides edges alone */
    unsigned open; /* operations to report */
};

static bool draws_numbers(const struct pass *pass)
{
    for (uint32_t i = 0; i < pass->access_count; i++) {
        const struct resource *resource = pass->accesses[i].resource;
        if (pass->accesses[i].mode != MODE_READ &&
            !(resource->kind == DT_IMAGE &&
              (format_info(resource->format)->integer || resource->format == DT_FORMAT_D32F)))
            return false;
    }
    return pass->kind == PASS_SCENE;
}

static void count_open(void *user, const struct open_operation *operation)
{
    struct proving *proving = user;
    proving->open += proving->model->prove || operation->wrong;
}

static void report_open(void *user, const struct open_operation *operation)
{
    const struct proving *proving = user;
    const struct model *model = proving->model;
    if (!model->prove && !operation->wrong)
        return;
    if (!operation->file || operation->file > model->glsl_source_count) {
        diag_error(proving->diag, proving->pass->shader_loc,
                   "pass %s, in the generated GLSL: `%s` is not exact: %s", proving->pass->name,
                   operation->word, operation->why);
        return;
    }
    struct loc loc = {model->glsl_sources[operation->file - 1], (int)operation->line, 1, 1};
    find_in_line(&loc, operation->word, strlen(operation->word));
    if (operation->raster && proving->numbers)
        diag_warning(proving->diag, loc, "`%s` decides at edges: %s", operation->word,
                     operation->why);
    else
        diag_error(proving->diag, loc, "`%s` is not exact: %s%s", operation->word, operation->why,
                   operation->wrong ? "; exact mode replaces it, but not in a macro" : "");
}

/* OpLine names files, not the numbers that #line has: `#line 12 3` becomes `#line 12 "3"`. */
static void add_lines(const char *code, struct text *out)
{
    unsigned row, file;
    for (const char *end; *code; code = end) {
        end = code + strcspn(code, "\n");
        end += *end == '\n';
        if (sscanf(code, "#line %u %u", &row, &file) == 2)
            text_add(out, "#line %u \"%u\"\n", row, file);
        else
            text_add_bytes(out, code, (size_t)(end - code));
        if (!strncmp(code, "#version", 8))
            text_add(out, "#extension GL_GOOGLE_cpp_style_line_directive : enable\n");
    }
}

void spirv_prove(const struct model *model, const struct pass *pass, const struct shader *shader,
                 struct diag *diag)
{
    struct proving proving = {model, pass, diag, draws_numbers(pass), 0};
    struct shader lined = {.stage = shader->stage};
    bool good = prove_module(shader->words, shader->word_count, count_open, &proving);
    if (good && proving.open) {
        add_lines(shader_code(shader)->data, &lined.glsl);
        good = lined.glsl.data && !lined.glsl.failed && spirv_init() &&
               compile(model, pass, true, &lined, diag) &&
               prove_module(lined.words, lined.word_count, report_open, &proving);
    }
    if (!good)
        diag_error(diag, pass->shader_loc, "out of memory");
    text_free(&lined.glsl);
    free(lined.words);
}
