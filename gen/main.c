/* diptych-gen: reads one pipeline spec; writes GLSL, SPIR-V, C and a graph. This file has the
 * command line and runs the stages (load.h). Exit status: 0 done, 1 the spec is wrong, 2 another
 * failure (usage, files, memory). */
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/command.h"
#include "base/installed.h"
#include "base/limit.h"
#include "load.h"
#include "model/sanitize_kinds.h"
#include "print/output.h"
#include "print/print.h"
#include "spirv/compile.h"
#include "spirv/watchdog.h"

/* Longest line of generated C; strings, which hold GLSL, may be longer. */
enum { GENERATED_COLUMNS = 100 };

enum status { STATUS_DONE = 0, STATUS_WRONG_SPEC = 1, STATUS_FAILED = 2 };

/* ---- Command line ---------------------------------------------------------------------------- */

struct options {
    const char *spec, *out, *graph, *lifetimes, *depfile, *json, *cache, *limit, *templates, *with,
        *sanitize;
    struct text_list sets;
    char *with_text;
    bool check, prove, needs, names, glsl, codes, schema, reference, help, version;
};

#define ROW(name, kind, field, argument, help)                                                     \
    {                                                                                              \
        name, kind, offsetof(struct options, field), 1, 0, argument, help                          \
    }

static const struct option_row option_rows[] = {
    {"SPEC", OPTION_STRING, offsetof(struct options, spec), 1, 1, NULL,
     "the pipeline, YAML; or the name of a shipped one, like rsm; --reference prints the language"},
    ROW("-o", OPTION_STRING, out, "DIR", "folder for the generated files; made when it is missing"),
    ROW("--set", OPTION_TEXTS, sets, "PATH=VALUE",
        "override a parameter by name or any value by its dotted path; may be repeated"),
    ROW("--with", OPTION_STRING, with, "FILE",
        "overrides from a file, before those of --set: lines `- PATH=VALUE`, as `diptych tune` "
        "writes them"),
    ROW("--names", OPTION_FLAG, names, NULL,
        "keep names and sources in the SPIR-V of generated C, for debuggers such as RenderDoc"),
    ROW("--glsl", OPTION_FLAG, glsl, NULL,
        "also put OpenGL's GLSL into generated C, for hosts that set `glsl`"),
    ROW("--codes", OPTION_FLAG, codes, NULL,
        "exact passes read codes of sRGB textures, which spares arithmetic: the host's are mutable "
        "(Vulkan: it gives `texture_codes`) or immutable (OpenGL)"),
    ROW("--sanitize", OPTION_WORDS, sanitize, "KINDS",
        "generated shaders look for undefined behaviour, and NAME_report() logs what they found, "
        "in file and line; --sanitize=KINDS: some of " SANITIZE_WORDS),
    ROW("--check", OPTION_FLAG, check, NULL, "check only, write nothing"),
    ROW("--prove", OPTION_FLAG, prove, NULL,
        "check only, and prove that the pipeline is exact: a remark for each operation that a "
        "driver may round as it likes, with the form that has one result, and the values of its "
        "operands: `library` (the whole function), `constant` (shorter, for a constant operand), "
        "`product` (with the reciprocal), `instruction` (the driver's own, which those values "
        "allow); an error for each operation and input whose bits the standards leave open, and "
        "for blending, lines, points and other fixed functions of draws, in passes that write a "
        "resource whose contract is exact; prints what the proof assumes; a warning for each value "
        "of the rasterizer in draws of the scene that leave only numbers and depth, where it "
        "decides edges"),
    ROW("--needs", OPTION_FLAG, needs, NULL,
        "check only, and print what the passes need of a Vulkan device, against the profiles "
        "Roadmap 2022, Android baseline 2022 and what MoltenVK has"),
    ROW("--graph", OPTION_STRING, graph, "FILE.dot",
        "draw passes, what they read and write and wait for, for Graphviz: dot -Tsvg"),
    ROW("--lifetimes", OPTION_STRING, lifetimes, "FILE.dot",
        "draw when resources live, and which of them share memory"),
    ROW("--depfile", OPTION_STRING, depfile, "FILE",
        "write the files that were read, as a makefile rule for ninja"),
    ROW("--json", OPTION_STRING, json, "FILE",
        "also write what was generated, or the errors, as JSON"),
    ROW("--cache", OPTION_STRING, cache, "DIR",
        "keep compiled shaders there, at most DIPTYCH_CACHE_MIB (default: 64): the next generation "
        "compiles only those that have changed"),
    ROW("--limit", OPTION_STRING, limit, "SECONDS",
        "end with an error after that much processor time (default: 60)"),
    ROW("--templates", OPTION_STRING, templates, "DIR",
        "folder with glsl/ (default: templates here, else those that came with the program)"),
    ROW("--schema", OPTION_FLAG, schema, NULL, "print a JSON Schema of the spec language"),
    ROW("--reference", OPTION_FLAG, reference, NULL,
        "print the reference of the spec language, Markdown"),
    ROW("--help", OPTION_FLAG, help, NULL, "show this"),
    ROW("--version", OPTION_FLAG, version, NULL, "print the version"),
};

static const struct command_line command = {
    .program = "diptych-gen",
    .bit = 1,
    .summary = "generate GLSL, SPIR-V and C for OpenGL and Vulkan from a pipeline spec",
    .details = "-o, --check, --prove, --needs, --graph or --lifetimes says what to make.\n"
               "Exit status: 0 done, 1 the spec is wrong, 2 it could not be tried.",
    .rows = option_rows,
    .row_count = DT_ARRAY_COUNT(option_rows),
};

static void print_option_message(void *user, enum dt_level level, const char *message)
{
    (void)user;
    fprintf(stderr, "diptych-gen: %s: %s\n", level == DT_ERROR ? "error" : "warning", message);
}

static bool usage_error(const char *text, const char *what)
{
    fprintf(stderr, "diptych-gen: error: ");
    fprintf(stderr, text, what);
    fprintf(stderr, "; see diptych-gen --help\n");
    return false;
}

static bool parse_options(int count, char **words, struct options *options)
{
    const struct dt_log log = {.message = print_option_message};
    if (!command_parse(&command, options, count - 1, words + 1, &log) ||
        (options->with && !options->help &&
         !command_overlay(&options->sets, options->with, &options->with_text, &log)))
        return false;
    if (options->help || options->version || options->schema || options->reference)
        return true;
    if (!command_is_complete(&command, options, &log))
        return false;
    if (!options->out && !options->check && !options->prove && !options->needs && !options->graph &&
        !options->lifetimes)
        return usage_error("-o DIR is missing for %s", options->spec);
    if (options->depfile && !options->out)
        return usage_error("--depfile %s needs -o DIR", options->depfile);
    return true;
}

/* ---- Generation ------------------------------------------------------------------------------ */

struct generation {
    const struct options *options;
    char *templates, *spec_path;
    struct spec spec, gpu;     /* gpu: `target: auto`, the same planned for GPUs; else empty */
    size_t gpu_bytes;          /* of both backends' packed shaders in generated C, for GPUs alone */
    struct diag *diag, *forms; /* forms: remarks of --prove */
    struct output *output;
};

static const char *const backend_names[] = {"gl", "vk"};
static const char *const stage_suffixes[] = {"comp", "vert", "frag"};

static void add_named(struct generation *g, const char *suffix, struct text *text)
{
    const char *name =
        arena_printf(g->spec.model.arena, "%s%s", g->spec.model.pipeline.name, suffix);
    if (name)
        output_add(g->output, g->options->out, name, text);
    else
        text_free(text);
}

/* FOLDER/NAME.PASS.comp and FOLDER/NAME.PASS.comp.spv. The output takes the GLSL, and gets a copy of
 * the SPIR-V. */
static void add_shader(struct generation *g, const char *folder, const struct pass *pass, int stage,
                       struct shader *shader)
{
    struct arena *arena = g->spec.model.arena;
    const char *name = arena_printf(arena, "%s/%s.%s.%s", folder, g->spec.model.pipeline.name,
                                    pass->name, stage_suffixes[stage]);
    const char *binary = arena_printf(arena, "%s.spv", name ? name : "");
    if (!name || !binary)
        return;
    struct text words = {0};
    text_add_bytes(&words, (const char *)shader->words, shader->word_count * sizeof *shader->words);
    output_add(g->output, g->options->out, name,
               shader->whole.length ? &shader->whole : &shader->glsl);
    output_add(g->output, g->options->out, binary, &words);
}

/* For every backend, pass and stage; in gl/gpu and vk/gpu those that GPUs have of their own. */
static void add_shaders(struct generation *g)
{
    static const char *const gpu_folders[] = {"gl/gpu", "vk/gpu"};
    const struct pipeline *pipeline = &g->spec.model.pipeline;
    for (int backend = 0; backend < 2; backend++)
        for (uint32_t i = 0; i < pipeline->pass_count; i++)
            for (int stage = 0; stage < 3; stage++) {
                struct shader *shader = &g->spec.shaders[backend][i].stage[stage];
                struct shader *gpu =
                    g->spec.tables->gpu ? &g->gpu.shaders[backend][i].stage[stage] : NULL;
                if (!shader->word_count)
                    continue;
                if (gpu && !shaders_are_same(shader, gpu))
                    add_shader(g, gpu_folders[backend], pipeline->order[i], stage, gpu);
                add_shader(g, backend_names[backend], pipeline->order[i], stage, shader);
            }
}

/* As GCC writes and ninja reads: backslashes before an escaped character are doubled. A line break
 * cannot be written; false, reported. */
static bool add_depfile_path(struct text *text, const char *path)
{
    if (strchr(path, '\n')) {
        fprintf(stderr, "diptych-gen: error: a depfile cannot name `%s`, which has a line break\n",
                path);
        return false;
    }
    for (size_t run = 0; *path; path++) {
        bool escaped = *path == ' ' || *path == '#';
        for (size_t i = 0; escaped && i <= run; i++)
            text_add(text, "\\");
        text_add(text, *path == '$' ? "$$" : "%c", *path);
        run = *path == '\\' ? run + 1 : 0;
    }
    return true;
}

static bool add_depfile(struct generation *g)
{
    const char *out = g->options->out ? g->options->out : ".";
    struct text text = {0};
    const char *slash = *out && out[strlen(out) - 1] == '/' ? "" : "/";
    const char *target =
        arena_printf(g->spec.model.arena, "%s%s%s.h", out, slash, g->spec.model.pipeline.name);
    bool good = add_depfile_path(&text, target ? target : "");
    text_add(&text, ":");
    for (uint32_t i = 0; i < g->spec.model.input_count && good; i++) {
        text_add(&text, " \\\n  ");
        good = add_depfile_path(&text, g->spec.model.inputs[i]);
    }
    text_add(&text, "\n");
    output_add(g->output, "", g->options->depfile, &text);
    return good;
}

static bool add_drawing(struct generation *g, const char *drawing, const char *path)
{
    struct text text = {0};
    if (path && !emit_drawing(&g->spec.model, drawing, &text)) {
        text_free(&text);
        return false;
    }
    if (path)
        output_add(g->output, "", path, &text);
    return true;
}

static void add_sources(struct generation *g)
{
    const struct model *model = &g->spec.model;
    const struct lowered *tables = g->spec.tables;
    struct text header = {0}, panel = {0}, gl_shaders = {0}, vk_shaders = {0};
    emit_header(model, &header);
    emit_c_panel(tables, &panel);
    g->gpu_bytes =
        emit_c_shaders(tables, BACKEND_GL, g->options->names, g->options->glsl, &gl_shaders) +
        emit_c_shaders(tables, BACKEND_VK, g->options->names, g->options->glsl, &vk_shaders);
    text_wrap(&header, GENERATED_COLUMNS);
    text_wrap(&panel, GENERATED_COLUMNS);
    add_named(g, ".h", &header);
    add_named(g, ".c", &panel);
    add_named(g, "_gl_shaders.c", &gl_shaders);
    add_named(g, "_vk_shaders.c", &vk_shaders);
    add_shaders(g);
}

static enum status write_files(struct generation *g)
{
    g->output = output_create();
    if (!g->output) {
        fputs("diptych-gen: error: out of memory\n", stderr);
        return STATUS_FAILED;
    }
    if (g->options->out)
        add_sources(g);
    if (!add_drawing(g, "graph", g->options->graph) ||
        !add_drawing(g, "lifetimes", g->options->lifetimes) ||
        (g->options->depfile && !add_depfile(g)))
        return STATUS_FAILED;
    return output_commit(g->output) ? STATUS_DONE : STATUS_FAILED;
}

static void print_summary(const struct pipeline *pipeline, size_t gpu_bytes)
{
    const double mebi = 1024.0 * 1024.0;
    double whole = (double)pipeline->transient_bytes / mebi,
           aliased = (double)pipeline->aliased_bytes / mebi;
    printf("%s: %u passes, %u resources; transients at 1920x1080: %.1f MiB, with aliasing %.1f MiB",
           pipeline->name, pipeline->pass_count, pipeline->resource_count, whole, aliased);
    if (whole > 0)
        printf(" (%.0f %% saved)", 100 * (1 - aliased / whole));
    if (gpu_bytes)
        printf("; shaders for GPUs add %zu KB", (gpu_bytes + 1023) / 1024);
    printf("\n");
}

/* Parses a whole number from least to most; NULL gives `otherwise`. Reports other texts and returns
 * false. */
static bool read_whole_number(const char *name, const char *text, uint64_t least, uint64_t most,
                              uint64_t otherwise, uint64_t *number)
{
    char *end = NULL;
    errno = 0;
    *number = text ? strtoull(text, &end, 10) : otherwise;
    if (!text ||
        (*text >= '0' && *text <= '9' && !*end && !errno && *number >= least && *number <= most))
        return true;
    fprintf(stderr,
            "diptych-gen: error: %s %s: must be a whole number from %" PRIu64 " to %" PRIu64 "\n",
            name, text, least, most);
    return false;
}

/* Prints the text, and frees it. */
static enum status print_text(struct text *text)
{
    if (text->failed)
        fputs("diptych-gen: error: out of memory\n", stderr);
    else
        fwrite(text->data, 1, text->length, stdout); /* main checks the stream */
    enum status status = text->failed ? STATUS_FAILED : STATUS_DONE;
    text_free(text);
    return status;
}

/* Also for GPUs where the spec leaves it open. */
static bool load(struct generation *g, const struct spec_request *request, bool tables)
{
    struct diag *diag = diag_create();
    if (!diag)
        return diag_error(g->diag, (struct loc){0}, "out of memory");
    bool good = spec_load_both((struct spec *[]){&g->spec, &g->gpu}, request, tables,
                               (struct diag *[]){g->diag, diag});
    bool second = !good && !diag_error_count(g->diag);
    diag_free(second ? g->diag : diag);
    g->diag = second ? diag : g->diag;
    if (good && g->gpu.tables && !emit_is_same(g->spec.tables, g->gpu.tables))
        g->spec.tables->gpu = g->gpu.tables;
    return good;
}

static enum status generate(struct generation *g)
{
    const struct options *options = g->options;
    uint64_t seconds;
    if (!read_whole_number("--limit", options->limit, 1, 3600, SPEC_SECONDS, &seconds))
        return STATUS_FAILED;
    struct spec_request request = {.path = g->spec_path,
                                   .sets = options->sets.items,
                                   .set_count = options->sets.count,
                                   .templates = g->templates,
                                   .prove = options->prove ? g->forms : NULL,
                                   .codes = options->codes,
                                   .text = options->out != NULL,
                                   .cache = options->cache};
    const char *end = NULL;
    request.sanitize = options->sanitize ? sanitize_kinds(options->sanitize, &end) : 0;
    if (options->sanitize && !request.sanitize) {
        fprintf(stderr, "diptych-gen: error: --sanitize: unknown kind \"%s\"; there are %s\n", end,
                SANITIZE_WORDS);
        return STATUS_FAILED;
    }
    if (!limit_memory(SPEC_GIBIBYTES) || !watchdog_start((unsigned)seconds, STATUS_WRONG_SPEC)) {
        fprintf(stderr, "diptych-gen: error: no limits: %s\n", strerror(errno));
        return STATUS_FAILED;
    }
    bool good = load(g, &request, options->out || options->needs);
    watchdog_stop();
    if (!good)
        return STATUS_WRONG_SPEC;
    if (options->needs) {
        struct text text = {0};
        emit_device_needs(g->spec.tables->gpu ? g->spec.tables->gpu : g->spec.tables, &text);
        return print_text(&text);
    }
    enum status status = options->check || options->prove ? STATUS_DONE : write_files(g);
    if (status == STATUS_DONE)
        print_summary(&g->spec.model.pipeline, g->gpu_bytes);
    if (status == STATUS_DONE && options->prove) {
        diag_print(g->forms, command.program, stdout);
        printf("%s\n", prove_assumptions);
    }
    return status;
}

/* The given folder, else `templates` in the working folder, else the one that came with the program. */
static char *find_templates(const char *given)
{
    const struct dt_log log = {.message = print_option_message};
    const char *here = given ? given : access("templates/glsl", R_OK) == 0 ? "templates" : NULL;
    return here ? strdup(here) : templates_folder(&log);
}

static void add_summary_json(const struct model *model, struct text *text)
{
    const struct pipeline *pipeline = &model->pipeline;
    text_add(text, ",\n  \"pipeline\": ");
    text_add_json(text, pipeline->name);
    text_add(text,
             ",\n  \"passes\": %" PRIu32 ",\n  \"resources\": %" PRIu32
             ",\n  \"transient_bytes\": %" PRIu64 ",\n  \"aliased_bytes\": %" PRIu64
             ",\n  \"inputs\": [",
             pipeline->pass_count, pipeline->resource_count, pipeline->transient_bytes,
             pipeline->aliased_bytes);
    for (uint32_t i = 0; i < model->input_count; i++) {
        text_add(text, i ? ", " : "");
        text_add_json(text, model->inputs[i]);
    }
    text_add(text, "]");
}

/* The same JSON format as `diptych VERB --json`. Also written when the spec is wrong. */
static enum status write_json(const struct generation *g, enum status status)
{
    struct output *output = output_create();
    struct text text = {0};
    text_add(&text,
             "{\n  \"verb\": \"%s\",\n  \"format\": 1,\n  \"exit_status\": %d,\n  \"errors\": [",
             g->options->check ? "check" : "generate", (int)status);
    diag_json(g->diag, &text);
    text_add(&text, "\n  ]");
    if (status == STATUS_DONE)
        add_summary_json(&g->spec.model, &text);
    if (status == STATUS_DONE && g->options->prove) {
        text_add(&text, ",\n  \"forms\": [");
        diag_json(g->forms, &text);
        text_add(&text, "\n  ]");
    }
    text_add(&text, "\n}\n");
    if (!output) {
        text_free(&text);
        return STATUS_FAILED;
    }
    output_add(output, "", g->options->json, &text);
    if (!output_commit(output))
        status = STATUS_FAILED;
    output_free(output);
    return status;
}

static enum status run_options(const struct options *options)
{
    struct generation g = {.options = options,
                           .diag = diag_create(),
                           .forms = diag_create(),
                           .spec.model.arena = arena_create()};
    enum status status = STATUS_FAILED;
    if (g.diag && g.forms && g.spec.model.arena) {
        g.templates = find_templates(options->templates);
        g.spec_path = find_in(options->spec, g.templates);
    }
    if (g.templates && g.spec_path) {
        status = generate(&g);
        if (options->json)
            status = write_json(&g, status);
        diag_print(g.diag, command.program, stderr);
    } else {
        fputs("diptych-gen: error: out of memory\n", stderr);
    }
    output_free(g.output);
    diag_free(g.forms);
    diag_free(g.diag);
    spec_free(&g.gpu);
    spec_free(&g.spec);
    free(g.templates);
    free(g.spec_path);
    return status;
}

/* ---- The command line ------------------------------------------------------------------------ */

static enum status print_reference(const struct options *options)
{
    const struct dt_log log = {.message = print_option_message};
    struct text text = {0};
    char *templates = find_templates(options->templates);
    bool good = templates && emit_reference(templates, &text, &log);
    free(templates);
    if (good)
        return print_text(&text);
    text_free(&text);
    return STATUS_FAILED;
}

static enum status run_words(int argc, char **argv)
{
    struct options options = {0};
    struct text text = {0};
    enum status status = STATUS_DONE;
    if (!parse_options(argc, argv, &options))
        status = STATUS_FAILED;
    else if (options.help)
        command_help(&command);
    else if (options.version)
        printf("diptych-gen " VERSION "\n"); /* build.ninja defines VERSION */
    else if (options.schema) {
        emit_schema(&text);
        status = print_text(&text);
    } else if (options.reference) {
        status = print_reference(&options);
    } else {
        status = run_options(&options);
    }
    free(options.sets.items);
    free(options.with_text);
    return status;
}

int main(int argc, char **argv)
{
    enum status status = STATUS_DONE;
    if (argc == 2 && !strcmp(argv[1], "--describe"))
        command_describe(&command);
    else
        status = run_words(argc, argv);
    if (!fflush(stdout) && !ferror(stdout))
        return (int)status;
    fputs("diptych-gen: error: cannot write to the standard output\n", stderr);
    return STATUS_FAILED;
}
