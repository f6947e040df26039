/* GLSL to SPIR-V: glslang, then the passes of this room, then spirv-val. Messages of glslang are
 * reported at the line of the original file. */
#include "model/foreign.h"
#include "model/source.h"
#include "model/spirv_check.h"
#include "glsl/glsl.h"
#include "plan/plan.h"
#include "compile.h"
#include "exact.h"
#include "glsl/initials.h"
#include "link.h"
#include "passes.h"
#include "prove.h"
#include "sanitize.h"
#include "values.h"
#include "whole.h"

#include <glslang/build_info.h>
#include <spirv-tools/libspirv.h>
#include <spirv/unified1/spirv.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Start ----------------------------------------------------------------------------------- */

bool spirv_init(bool whole)
{
    static atomic_bool started[2];
    if (!started[whole])
        started[whole] = spirv_library_start() && glslang_start(whole);
    return started[whole];
}

#define WORD(text)      #text
#define DOTTED(a, b, c) WORD(a) "." WORD(b) "." WORD(c)

const char *spirv_tools(void)
{
    static char tools[256];
    snprintf(tools, sizeof tools, "glslang %s, %s, exact.glsl %08x",
             DOTTED(GLSLANG_VERSION_MAJOR, GLSLANG_VERSION_MINOR, GLSLANG_VERSION_PATCH),
             spvSoftwareVersionString(), spirv_library_hash());
    return tools;
}

/* ---- Compiling ------------------------------------------------------------------------------- */

struct adding {
    const struct model *model;
    const struct pass *pass;
};

static uint32_t add_site(void *user, const struct sanitize_site *site)
{
    const struct adding *adding = user;
    return sanitize_add(adding->model, adding->pass, site);
}

static bool sanitize(const struct model *model, const struct pass *pass, uint32_t turn,
                     struct spirv *module)
{
    struct adding adding = {model, pass};
    if (!model->sanitize)
        return true;
    sanitize_begin_turn(model, turn);
    bool good = spirv_sanitize(
        module, &(struct sanitize_request){model->sanitize, pass, add_site, &adding});
    sanitize_end_turn(model, turn);
    return good && !sanitize_failed(model);
}

struct proving {
    const struct model *model;
    const struct pass *pass;
    struct diag *diag;
    bool numbers;  /* a scene draw leaves numbers and depth: the rasterizer decides edges alone */
    unsigned open; /* operations to report */
};

/* The place of an operation; that of the pass's shader for the generator's own text. */
static struct loc place_of(const struct proving *proving, uint32_t file, uint32_t line)
{
    const struct model *model = proving->model;
    bool known = file && file <= model->glsl_source_count;
    return known ? (struct loc){model->glsl_sources[file - 1], (int)line, 1, 1}
                 : proving->pass->shader_loc;
}

static void tell_form(void *user, uint32_t file, uint32_t line, const char *word, const char *form)
{
    const struct proving *proving = user;
    struct loc loc = place_of(proving, file, line);
    glsl_find_in_line(&loc, word, strlen(word));
    if (proving->model->prove)
        diag_remark(proving->model->prove, loc, "%s: %s", word, form);
}

/* Numbers that an invocation has of its own: NVIDIA gives it 512 KiB, and LLVM takes hours for more. */
enum { MOST_OWN_NUMBERS = 1 << 17 };

static bool variables_fit(const struct spirv *module, char **log)
{
    uint64_t count = 0;
    SPIRV_EACH(module, i, module->declarations, module->count)
        if (spirv_is(i, SpvOpVariable) &&
            (i[3] == SpvStorageClassFunction || i[3] == SpvStorageClassPrivate))
            count += spirv_scalars(module, spirv_pointee(module, i));
    if (count > MOST_OWN_NUMBERS && !*log)
        *log = format_string("the variables of an invocation hold %llu numbers; drivers take %d",
                             (unsigned long long)count, MOST_OWN_NUMBERS);
    return count <= MOST_OWN_NUMBERS;
}

/* The passes; takes over the module. proving: gets the forms of operations; may be NULL. */
static bool pass_module(const struct model *model, const struct pass *pass, struct spirv module,
                        struct shader *shader, struct proving *proving, char **log)
{
    bool good = variables_fit(&module, log) && sanitize(model, pass, shader->turn, &module) &&
                (pass->fast || spirv_settle_globals(&module)) && spirv_end_entry(&module);
    for (uint32_t i = 0; good && i < pass->access_count; i++)
        if (access_is_texels(&pass->accesses[i]))
            good = spirv_texels(&module, pass->accesses[i].name);
    good = good &&
           (pass->fast || (spirv_values(&module, pass, log) &&
                           spirv_exact(&module, proving ? tell_form : NULL, proving))) &&
           spirv_reach(&module);
    if (good)
        shader->words = spirv_take(&module, &shader->word_count);
    else
        spirv_free(&module);
    return good;
}

static bool validate(const struct pass *pass, const struct shader *shader, struct diag *diag)
{
    char *why = NULL;
    bool valid = spirv_check(shader->words, shader->word_count, diag ? &why : NULL);
    if (!valid && diag)
        diag_error(diag, pass->shader_loc, "pass %s: %s", pass->name, why ? why : "out of memory");
    free(why);
    return valid;
}

/* OpenGL takes SPIR-V 1.0, and by GL_KHR_shader_subgroup 1.3, which brought subgroup operations. In
 * 1.5 a vertex shader's layer is a capability of its own, as some devices have it. least: of a module that this one joins. */
static int minor_version(const struct shader *shader, uint32_t least)
{
    if ((shader->own && !shader->code.length) || least > 0x10300)
        return 5; /* Vulkan's own */
    return strstr(shader_code(shader)->data, "\n#extension GL_KHR_shader_subgroup_basic") ? 3 : 0;
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
            text_add(out, "#extension GL_GOOGLE_cpp_style_line_directive : enable\n"
                          "#line 2 \"0\"\n"); /* generated text is of no file */
    }
}

/* Whether instructions stand in it that mean nothing to a result, such as debugPrintfEXT(). */
static bool has_notes(const struct spirv *module)
{
    bool found = false;
    SPIRV_EACH(module, i, SPIRV_HEADER, module->annotations)
        found |=
            spirv_is(i, SpvOpExtInstImport) && !strncmp((const char *)(i + 2), "NonSemantic.", 12);
    return found;
}

/* Text to a module. lines: with OpLine, which makes no valid module of all that follows. */
bool spirv_read_text(const struct pass *pass, const struct shader *shader, const struct text *text,
                     bool lines, uint32_t least, struct spirv *module, char **log)
{
    struct text lined = {0};
    if (lines)
        add_lines(text->data, &lined);
    const struct glslang_job job = {.code = lines ? lined.data : text->data,
                                    .stage = shader->stage,
                                    .minor = minor_version(shader, least),
                                    .lines = lines,
                                    .whole = shader->whole.length,
                                    .marked = !pass->fast,
                                    .include = glsl_include,
                                    .user = shader->files};
    size_t count;
    uint32_t *words = lined.failed || !job.code ? NULL : glsl_compile_whole(&job, &count, log);
    text_free(&lined);
    *module = (struct spirv){0};
    return words && spirv_read(module, words, count) &&
           (!has_notes(module) || spirv_reread(module, SPIRV_FLATTEN)) &&
           spirv_lower_memory(module) && spirv_demote(module);
}

/* The author's module; of a whole shader it is joined by the generator's and bound. proving: with lines. */
static bool compile(const struct model *model, const struct pass *pass, struct proving *proving,
                    struct shader *shader, char **log)
{
    struct spirv module = {0}, more = {0};
    bool whole = shader->whole.length, lines = model->sanitize || proving;
    bool good = !whole || whole_read(model, pass, shader, lines, &module, log);
    uint32_t least = good && whole ? module.words[1] : 0;
    good = good && spirv_read_text(pass, shader, shader_code(shader), lines, least,
                                   whole ? &more : &module, log);
    if (good && whole)
        good = whole_bind(pass, shader, &more, &module, log);
    spirv_free(&more);
    if (good)
        return pass_module(model, pass, module, shader, proving, log);
    spirv_free(&module);
    return false;
}

bool spirv_compile(const struct model *model, const struct pass *pass, enum backend backend,
                   struct shader *shader, char **log, struct diag *diag)
{
    char *unread = NULL;
    bool second =
        model->pipeline.gpu && model->pipeline.automatic; /* the first has the same body */
    bool good = compile(model, pass, NULL, shader, log ? log : &unread) &&
                (second || validate(pass, shader, diag));
    free(unread);
    return good && (backend == BACKEND_VK || spirv_make_opengl(pass, shader));
}

bool spirv_for_cpu(struct shader *shader, char **why)
{
    struct spirv module;
    size_t before = shader->word_count;
    bool good = spirv_read(&module, shader->words, shader->word_count) && spirv_keep_loops(&module);
    shader->words = spirv_take(&module, &shader->word_count);
    return good &&
           (shader->word_count == before || spirv_check(shader->words, shader->word_count, why));
}

bool spirv_make_opengl(const struct pass *pass, struct shader *shader)
{
    struct spirv module;
    bool good = spirv_read(&module, shader->words, shader->word_count) &&
                spirv_for_opengl(&module, pass->indirect_resource);
    shader->words = spirv_take(&module, &shader->word_count);
    return good;
}

/* ---- Proof ----------------------------------------------------------------------------------- */

static bool draws_numbers(const struct pass *pass)
{
    EACH(access, pass->accesses, pass->access_count) {
        const struct resource *resource = access->resource;
        if (access->mode != MODE_READ &&
            !(resource->kind == DT_IMAGE &&
              (format_is_integer(resource->format) || resource->format == DT_FORMAT_D32F)))
            return false;
    }
    return pass->kind == DT_PASS_DRAW_SCENE;
}

static void count_open(void *user, const struct open_operation *operation)
{
    struct proving *proving = user;
    proving->open += proving->model->prove || operation->wrong;
}

static void report_open(void *user, const struct open_operation *operation)
{
    const struct proving *proving = user;
    struct loc loc = place_of(proving, operation->file, operation->line);
    if (!proving->model->prove && !operation->wrong)
        return;
    if (loc.source == proving->pass->shader_loc.source) {
        const char *function = operation->function ? operation->function : "main";
        diag_error(proving->diag, loc, "pass %s, in `%.*s`: `%s` is not exact: %s",
                   proving->pass->name, (int)strcspn(function, "("), function, operation->word,
                   operation->why);
        return;
    }
    while (!glsl_find_in_line(&loc, operation->word, strlen(operation->word)) && operation->wrong &&
           loc.line > 1) /* up to where the function begins */
        loc.line--;
    if (operation->ends)
        diag_warning(proving->diag, loc, "`%s` %s", operation->word, operation->why);
    else if (operation->raster && proving->numbers)
        diag_warning(proving->diag, loc, "`%s` decides at edges: %s", operation->word,
                     operation->why);
    else
        diag_error(proving->diag, loc, "`%s` is not exact: %s", operation->word, operation->why);
}

static bool prove_words(const struct shader *shader,
                        void (*found)(void *user, const struct open_operation *operation),
                        struct proving *proving)
{
    struct spirv module;
    bool good = spirv_open(&module, shader->words, shader->word_count) &&
                prove_module(&module, found, proving);
    spirv_free(&module);
    return good;
}

void spirv_prove(const struct model *model, const struct pass *pass, const struct shader *shader,
                 struct diag *diag)
{
    struct proving proving = {model, pass, diag, draws_numbers(pass), 0};
    struct shader lined = *shader;
    struct model plain = *model; /* checks of --sanitize have no lines */
    char *log = NULL;
    plain.sanitize = 0;
    bool good = prove_words(shader, count_open, &proving);
    if (good && (proving.open || model->prove)) {
        lined.words = NULL;
        good = spirv_init(shader->whole.length) && compile(&plain, pass, &proving, &lined, &log) &&
               prove_words(&lined, report_open, &proving);
    }
    if (!good)
        diag_error(diag, pass->shader_loc, "out of memory");
    free(log);
    if (lined.words != shader->words)
        free(lined.words);
}
