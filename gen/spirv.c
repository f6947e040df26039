/* GLSL to SPIR-V: glslang's C interface, NoContraction on all float arithmetic, spirv-val.
 * Called by main.c for every stage that emit_glsl.c wrote. Messages of glslang come back at the
 * line of the file that the text is from. */
#include "diag.h"
#include "stages.h"

#include <ctype.h>
#include <glslang/Include/glslang_c_interface.h>
#include <glslang/Public/resource_limits_c.h>
#include <spirv-tools/libspirv.h>
#define SPV_ENABLE_UTILITY_CODE /* SpvHasResultAndType */
#include <spirv/unified1/spirv.h>
#include <stdlib.h>
#include <string.h>

bool spirv_init(void)
{
    return glslang_initialize_process();
}

void spirv_finish(void)
{
    glslang_finalize_process();
}

/* ---- Messages -------------------------------------------------------------------------------- */

static bool is_word(char c)
{
    return isalnum((unsigned char)c) || c == '_';
}

/* Column and length of `word` in a line of the source; 1 and 1 when it is not there. */
static void find_in_line(struct loc *loc, const char *word, size_t length)
{
    const char *at = loc->source->text, *end = at + loc->source->length;
    for (int line = 1; line < loc->line && at; line++) {
        at = memchr(at, '\n', (size_t)(end - at));
        at = at ? at + 1 : NULL;
    }
    if (!at || !length)
        return;
    const char *newline = memchr(at, '\n', (size_t)(end - at));
    size_t width = (size_t)((newline ? newline : end) - at);
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
    static const char exact[] = "'exact_"; /* the author wrote the name without it */
    size_t added = (size_t)(stop - text) > sizeof exact && !memcmp(text, exact, sizeof exact - 1)
                       ? sizeof exact - 2
                       : 0;
    const char *close = *text == '\'' ? memchr(text + 1, '\'', (size_t)(stop - text - 1)) : NULL;
    if (close)
        find_in_line(&loc, text + 1 + added, (size_t)(close - text - 1) - added);
    if (close == text + 1) /* '' : text */
        text = close + 1 + strspn(close + 1, ": ");
    diag_error(diag, loc, "%.*s", (int)(stop - text), text);
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

/* The header has it as an inline function, whose one definition is here. */
extern void SpvHasResultAndType(SpvOp opcode, bool *hasResult, bool *hasResultType);

/* Type of every result, by id; 0: none. calloc'ed, as many as the module's bound. */
static uint32_t *result_types(const uint32_t *words, size_t count)
{
    uint32_t *types = calloc(words[3], sizeof *types);
    for (size_t at = 5; types && at < count; at += words[at] >> 16) {
        bool has_result, has_type;
        SpvHasResultAndType((SpvOp)(words[at] & 0xffff), &has_result, &has_type);
        if (has_result && has_type)
            types[words[at + 2]] = words[at + 1];
    }
    return types;
}

enum { MAX_TURNED = 4 + 4 * 5 + 7 + 5 }; /* words of a product that is turned */

static size_t put(uint32_t *out, size_t length, SpvOp opcode, const uint32_t *operands,
                  uint32_t count)
{
    out[length] = (count + 1) << 16 | opcode;
    memcpy(out + length + 1, operands, count * sizeof *out);
    return length + count + 1;
}

/* vector * matrix is the one product of matrices that drivers compute in an order of their own,
 * even with NoContraction: it becomes transpose(matrix) * vector. The columns are taken apart
 * and put together, because Mesa would see through the transpose alone. `components`: of the
 * vector type, 0 for a matrix that is not square, which keeps its instruction. Returns the words
 * written; `bound` grows by the new ids. */
static size_t turn_product(const uint32_t *product, uint32_t components, uint32_t matrix_type,
                           uint32_t *bound, uint32_t *out)
{
    uint32_t vector_type = product[1], transpose = (*bound)++, columns[6] = {matrix_type}, length;
    if (!components) {
        memcpy(out, product, 5 * sizeof *out);
        return 5;
    }
    length =
        (uint32_t)put(out, 0, SpvOpTranspose, (uint32_t[]){matrix_type, transpose, product[4]}, 3);
    for (uint32_t i = 0; i < components; i++) {
        columns[2 + i] = (*bound)++;
        length = (uint32_t)put(out, length, SpvOpCompositeExtract,
                               (uint32_t[]){vector_type, columns[2 + i], transpose, i}, 4);
    }
    columns[1] = (*bound)++;
    length = (uint32_t)put(out, length, SpvOpCompositeConstruct, columns, 2 + components);
    return put(out, length, SpvOpMatrixTimesVector,
               (uint32_t[]){vector_type, product[2], columns[1], product[3]}, 4);
}

/* Components of a vector type. */
static uint32_t vector_size(const uint32_t *words, size_t count, uint32_t type)
{
    for (size_t at = 5; at < count; at += words[at] >> 16)
        if ((words[at] & 0xffff) == SpvOpTypeVector && words[at + 1] == type)
            return words[at + 3];
    return 0;
}

/* The instructions from `from` on, products turned. */
static size_t copy_turned(const uint32_t *words, size_t from, size_t count, uint32_t *out,
                          size_t length)
{
    uint32_t *types = result_types(words, count), bound = words[3];
    if (!types)
        return 0;
    for (size_t at = from; at < count; at += words[at] >> 16) {
        const uint32_t *instruction = words + at;
        if ((*instruction & 0xffff) == SpvOpVectorTimesMatrix) {
            bool square = types[instruction[3]] == instruction[1];
            length +=
                turn_product(instruction, square ? vector_size(words, count, instruction[1]) : 0,
                             types[instruction[4]], &bound, out + length);
        } else {
            memcpy(out + length, instruction, (*instruction >> 16) * sizeof *out);
            length += *instruction >> 16;
        }
    }
    out[3] = bound;
    free(types);
    return length;
}

/* Position of the first declaration, behind all decorations; counts float arithmetic and vector
 * * matrix; marks results that `precise` has decorated already. */
static size_t survey(const uint32_t *words, size_t count, bool *decorated, size_t *results,
                     size_t *products)
{
    size_t insert = 0;
    for (size_t at = 5; at < count; at += words[at] >> 16) {
        uint32_t opcode = words[at] & 0xffff;
        if (!insert && is_declaration(opcode))
            insert = at;
        if (opcode == SpvOpDecorate && words[at + 2] == SpvDecorationNoContraction)
            decorated[words[at + 1]] = true;
        *results += is_float_arithmetic(opcode);
        *products += opcode == SpvOpVectorTimesMatrix;
    }
    return insert;
}

/* New words in which every result of float arithmetic has NoContraction and vector * matrix its
 * fixed order; NULL when out of memory. */
static uint32_t *make_exact(const uint32_t *words, size_t count, size_t *new_count)
{
    size_t results = 0, products = 0;
    bool *decorated = calloc(words[3], sizeof *decorated); /* by id */
    if (!decorated)
        return NULL;
    size_t insert = survey(words, count, decorated, &results, &products), length = insert;
    uint32_t *out = malloc((count + 3 * results + MAX_TURNED * products) * sizeof *out);
    if (out) {
        memcpy(out, words, insert * sizeof *out);
        for (size_t at = insert; at < count; at += words[at] >> 16)
            if (is_float_arithmetic(words[at] & 0xffff) && !decorated[words[at + 2]])
                length = put(out, length, SpvOpDecorate,
                             (uint32_t[]){words[at + 2], SpvDecorationNoContraction}, 2);
        *new_count = copy_turned(words, insert, count, out, length);
        if (!*new_count) {
            free(out);
            out = NULL;
        }
    }
    free(decorated);
    return out;
}

/* ---- Compiling ------------------------------------------------------------------------------- */

static glslang_stage_t stage_of(enum stage stage)
{
    static const glslang_stage_t stages[] = {GLSLANG_STAGE_COMPUTE, GLSLANG_STAGE_VERTEX,
                                             GLSLANG_STAGE_FRAGMENT};
    return stages[stage];
}

static bool take_words(const struct model *model, glslang_program_t *program, struct shader *shader)
{
    size_t count = glslang_program_SPIRV_get_size(program);
    const uint32_t *words = glslang_program_SPIRV_get_ptr(program);
    if (model->pipeline.fast) {
        shader->words = malloc(count * sizeof *words);
        if (shader->words)
            memcpy(shader->words, words, count * sizeof *words);
        shader->word_count = count;
    } else {
        shader->words = make_exact(words, count, &shader->word_count);
    }
    return shader->words != NULL;
}

static bool validate(const struct pass *pass, enum backend backend, const struct shader *shader,
                     struct diag *diag)
{
    spv_context context =
        spvContextCreate(backend == BACKEND_GL ? SPV_ENV_OPENGL_4_5 : SPV_ENV_VULKAN_1_3);
    spv_diagnostic diagnostic = NULL;
    spv_result_t result =
        spvValidateBinary(context, shader->words, shader->word_count, &diagnostic);
    if (result != SPV_SUCCESS)
        diag_error(diag, pass->shader_loc, "pass %s: spirv-val says: %s", pass->name,
                   diagnostic && diagnostic->error ? diagnostic->error : "invalid module");
    spvDiagnosticDestroy(diagnostic);
    spvContextDestroy(context);
    return result == SPV_SUCCESS;
}

bool spirv_compile(const struct model *model, const struct pass *pass, enum backend backend,
                   struct shader *shader, struct diag *diag)
{
    bool vulkan = backend == BACKEND_VK;
    glslang_input_t input = {
        .language = GLSLANG_SOURCE_GLSL,
        .stage = stage_of(shader->stage),
        .client = vulkan ? GLSLANG_CLIENT_VULKAN : GLSLANG_CLIENT_OPENGL,
        .client_version = vulkan ? GLSLANG_TARGET_VULKAN_1_3 : GLSLANG_TARGET_OPENGL_450,
        .target_language = GLSLANG_TARGET_SPV,
        .target_language_version = vulkan ? GLSLANG_TARGET_SPV_1_5 : GLSLANG_TARGET_SPV_1_0,
        .code = shader->glsl.data,
        .default_version = 460,
        .default_profile = GLSLANG_CORE_PROFILE,
        .messages = GLSLANG_MSG_SPV_RULES_BIT | (vulkan ? GLSLANG_MSG_VULKAN_RULES_BIT : 0) |
                    GLSLANG_MSG_CASCADING_ERRORS_BIT,
        .resource = glslang_default_resource(),
    };
    glslang_shader_t *compiled = glslang_shader_create(&input);
    glslang_program_t *program = glslang_program_create();
    bool ok = compiled && program;
    if (!ok)
        diag_error(diag, pass->shader_loc, "pass %s: glslang could not start", pass->name);
    if (ok && !(ok = glslang_shader_preprocess(compiled, &input) &&
                     glslang_shader_parse(compiled, &input)))
        report_log(model, pass, glslang_shader_get_info_log(compiled), diag);
    if (ok) {
        glslang_program_add_shader(program, compiled);
        if (!(ok = glslang_program_link(program, input.messages)))
            report_log(model, pass, glslang_program_get_info_log(program), diag);
    }
    if (ok) {
        glslang_spv_options_t options = {.disable_optimizer = true};
        glslang_program_SPIRV_generate_with_options(program, input.stage, &options);
        ok = take_words(model, program, shader) && validate(pass, backend, shader, diag);
    }
    glslang_program_delete(program);
    glslang_shader_delete(compiled);
    return ok;
}
