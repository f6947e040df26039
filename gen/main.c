/* diptych-gen: one pipeline spec in; GLSL, SPIR-V, C and a graph out. This file is the command line
 * and the road through the stages (stages.h). Exit status: 0 done, 1 the spec is wrong, 2 it could
 * not be tried (usage, files, memory). */
#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "helper.h"
#include "shader_cache.h"

/* Longest line of generated C; strings, which hold GLSL, may be longer. */
enum { GENERATED_COLUMNS = 100 };

enum status { STATUS_DONE = 0, STATUS_WRONG_SPEC = 1, STATUS_FAILED = 2 };

/* ---- Command line ---------------------------------------------------------------------------- */

struct options {
    const char *spec, *out, *graph, *lifetimes, *depfile, *json, *shader_cache, *templates,
        *variations, *seed, *memory;
    const char **sets;
    size_t set_count;
    bool check, live, edits, schema, reference, help, version;
    bool started; /* the GLSL compiler is, by whoever runs this */
};

struct option_name {
    const char *name, *value; /* value: what it takes, NULL: nothing */
    const char *doc;
};
static const struct option_name option_names[] = {
    {"-o", "DIR", "folder for the generated files; made when it is missing"},
    {"--set", "PATH=VALUE",
     "override a value of the spec: a.b.c=VALUE, or PARAMETER=VALUE; may be repeated"},
    {"--check", NULL, "check only, write nothing"},
    {"--graph", "FILE.dot",
     "draw passes, what they read and write and wait for, for Graphviz: dot -Tsvg"},
    {"--lifetimes", "FILE.dot", "draw when resources live, and which of them share memory"},
    {"--depfile", "FILE", "write the files that were read, as a makefile rule for ninja"},
    {"--json", "FILE", "also write what was generated, or the errors, as JSON"},
    {"--shader-cache", "FILE",
     "keep compiled shaders there: the next generation compiles only those that have changed"},
    {"--edits", NULL,
     "for whoever waits at edits: heed `edits` of ranges, so that less is compiled then, and "
     "frames "
     "may take longer"},
    {"--templates", "DIR",
     "folder with glsl/; default: templates here, else those that came with the program"},
    {"--variations", "N",
     "print N random variations of the spec that are valid, as JSON; writes nothing else"},
    {"--seed", "S", "--variations: the same seed draws the same (default: 1)"},
    {"--memory", "MIB", "--variations: most that the resources of one may take (default: 64)"},
    {"--live", NULL, "print the names of the spec's live parameters, one a line"},
    {"--schema", NULL, "print a JSON Schema of the spec language"},
    {"--reference", NULL, "print the reference of the spec language, Markdown"},
    {"--help", NULL, "this text"},
    {"--version", NULL, "the version"},
};
enum { OPTION_COUNT = sizeof option_names / sizeof *option_names };

static void print_help(void)
{
    printf("usage: diptych-gen SPEC -o DIR [options]\n\nGenerates GLSL, SPIR-V and C for both "
           "runtimes from a pipeline spec.\n\n");
    for (size_t i = 0; i < OPTION_COUNT; i++) {
        const struct option_name *option = &option_names[i];
        int width = printf("  %s%s%s", option->name, option->value ? " " : "",
                           option->value ? option->value : "");
        printf("%*s%s\n", width < 24 ? 24 - width : 1, "", option->doc);
    }
}

/* For app/manual.awk, as diptych --describe has it. */
static void print_description(void)
{
    printf(
        "program\tdiptych-gen\tgenerate GLSL, SPIR-V and C for OpenGL and Vulkan from a pipeline "
        "spec\noption\tSPEC\t\trequired\tthe pipeline, YAML; --reference tells its language\n");
    for (size_t i = 0; i < OPTION_COUNT; i++)
        printf("option\t%s\t%s\t\t%s\n", option_names[i].name,
               option_names[i].value ? option_names[i].value : "", option_names[i].doc);
}

static bool usage_error(const char *text, const char *what)
{
    fprintf(stderr, "diptych-gen: error: ");
    fprintf(stderr, text, what);
    fprintf(stderr, "\ndiptych-gen: try `diptych-gen --help`\n");
    return false;
}

static bool unknown_option(const char *word)
{
    const char *names[OPTION_COUNT];
    for (size_t i = 0; i < OPTION_COUNT; i++)
        names[i] = option_names[i].name;
    const char *nearest = diag_nearest(word, names, OPTION_COUNT);
    if (!nearest)
        return usage_error("unknown option `%s`", word);
    fprintf(stderr, "diptych-gen: error: unknown option `%s`; did you mean `%s`?\n", word, nearest);
    fprintf(stderr, "diptych-gen: try `diptych-gen --help`\n");
    return false;
}

static void take_option(struct options *options, const char *name, const char *value)
{
    if (!strcmp(name, "-o"))
        options->out = value;
    else if (!strcmp(name, "--set"))
        options->sets[options->set_count++] = value;
    else if (!strcmp(name, "--graph"))
        options->graph = value;
    else if (!strcmp(name, "--lifetimes"))
        options->lifetimes = value;
    else if (!strcmp(name, "--depfile"))
        options->depfile = value;
    else if (!strcmp(name, "--json"))
        options->json = value;
    else if (!strcmp(name, "--shader-cache"))
        options->shader_cache = value;
    else if (!strcmp(name, "--templates"))
        options->templates = value;
    else if (!strcmp(name, "--variations"))
        options->variations = value;
    else if (!strcmp(name, "--seed"))
        options->seed = value;
    else if (!strcmp(name, "--memory"))
        options->memory = value;
    else if (!strcmp(name, "--check"))
        options->check = true;
    else if (!strcmp(name, "--live"))
        options->live = true;
    else if (!strcmp(name, "--edits"))
        options->edits = true;
    else if (!strcmp(name, "--schema"))
        options->schema = true;
    else if (!strcmp(name, "--reference"))
        options->reference = true;
    else if (!strcmp(name, "--help"))
        options->help = true;
    else
        options->version = true;
}

/* `word` is NAME, or NAME=VALUE for an option that takes a value. */
static bool parse_option(struct options *options, const char *word, const char *next,
                         bool *took_next)
{
    for (size_t i = 0; i < OPTION_COUNT; i++) {
        const struct option_name *option = &option_names[i];
        size_t length = strlen(option->name);
        if (strncmp(word, option->name, length) ||
            (word[length] && (word[length] != '=' || !option->value)))
            continue;
        const char *value = word[length] ? word + length + 1 : next;
        *took_next = option->value && !word[length];
        if (option->value && (!value || !*value))
            return usage_error("`%s` needs a value", option->name);
        take_option(options, option->name, value);
        return true;
    }
    return unknown_option(word);
}

static bool parse_options(int count, char **words, struct options *options)
{
    bool only_names = false;
    for (int i = 1; i < count; i++) {
        bool took_next = false;
        if (!only_names && !strcmp(words[i], "--")) {
            only_names = true;
        } else if (!only_names && words[i][0] == '-' && words[i][1]) {
            if (!parse_option(options, words[i], i + 1 < count ? words[i + 1] : NULL, &took_next))
                return false;
            i += took_next;
        } else if (options->spec) {
            return usage_error("one spec at a time; what is `%s`?", words[i]);
        } else {
            options->spec = words[i];
        }
    }
    if (options->help || options->version || options->schema || options->reference)
        return true;
    if (!options->spec)
        return usage_error("no spec given%s", "");
    if (!options->out && !options->check && !options->graph && !options->lifetimes &&
        !options->live && !options->variations)
        return usage_error("`-o DIR` is missing for `%s`", options->spec);
    if (options->json && (options->live || options->variations))
        return usage_error("`--json %s` goes with `-o`, `--check` and drawings", options->json);
    if (options->depfile && !options->out)
        return usage_error("`--depfile %s` needs `-o DIR`", options->depfile);
    return true;
}

/* ---- Generation ------------------------------------------------------------------------------ */

struct generation {
    const struct options *options;
    struct model model;
    struct diag *diag;
    struct pass_shaders *shaders[2]; /* per backend, pass_count each */
    struct shader_cache *cache;      /* NULL: none was asked for */
    struct output *output;
};

static const char *const backend_names[] = {"gl", "vk"};
static const char *const stage_suffixes[] = {"comp", "vert", "frag"};

static void add_named(struct generation *g, const char *suffix, struct text *text)
{
    const char *name = arena_printf(g->model.arena, "%s%s", g->model.pipeline.name, suffix);
    if (name)
        output_add(g->output, g->options->out, name, text);
    else
        text_free(text);
}

/* gl/PASS.comp and gl/PASS.comp.spv, and so on for every stage and backend. The SPIR-V is copied
 * last: emitters use it. */
static void add_shaders(struct generation *g)
{
    const struct pipeline *pipeline = &g->model.pipeline;
    for (int backend = 0; backend < 2; backend++)
        for (uint32_t i = 0; i < pipeline->pass_count; i++)
            for (int stage = 0; stage < 3; stage++) {
                struct shader *shader = &g->shaders[backend][i].stage[stage];
                const char *name = arena_printf(g->model.arena, "%s/%s.%s", backend_names[backend],
                                                pipeline->order[i]->name, stage_suffixes[stage]);
                const char *binary = arena_printf(g->model.arena, "%s.spv", name ? name : "");
                if (!shader->word_count || !name || !binary)
                    continue;
                struct text words = {0};
                text_add_bytes(&words, (const char *)shader->words,
                               shader->word_count * sizeof *shader->words);
                output_add(g->output, g->options->out, name, &shader->glsl);
                output_add(g->output, g->options->out, binary, &words);
            }
}

/* limit/PASS.c: a copy, since it is compiled against NAME.h, and the spec may lie anywhere. */
static void add_limits(struct generation *g)
{
    const struct pipeline *pipeline = &g->model.pipeline;
    for (uint32_t i = 0; i < pipeline->pass_count; i++) {
        const struct pass *pass = pipeline->order[i];
        const char *name = arena_printf(g->model.arena, "limit/%s.c", pass->name);
        if (!pass->limit_body || !name)
            continue;
        struct text text = {0};
        emit_limit(pass, &text);
        output_add(g->output, g->options->out, name, &text);
    }
}

static void add_depfile_path(struct text *text, const char *path)
{
    for (; *path; path++) {
        if (*path == ' ' || *path == '#')
            text_add(text, "\\");
        text_add(text, *path == '$' ? "$$" : "%c", *path);
    }
}

static void add_depfile(struct generation *g)
{
    const char *out = g->options->out ? g->options->out : ".";
    struct text text = {0};
    const char *slash = *out && out[strlen(out) - 1] == '/' ? "" : "/";
    const char *target =
        arena_printf(g->model.arena, "%s%s%s.h", out, slash, g->model.pipeline.name);
    add_depfile_path(&text, target ? target : "");
    text_add(&text, ":");
    for (uint32_t i = 0; i < g->model.input_count; i++) {
        text_add(&text, " \\\n  ");
        add_depfile_path(&text, g->model.inputs[i]);
    }
    text_add(&text, "\n");
    output_add(g->output, "", g->options->depfile, &text);
}

static void add_drawing(struct generation *g, const char *path,
                        void (*emit)(const struct model *model, struct text *out))
{
    struct text text = {0};
    emit(&g->model, &text);
    output_add(g->output, "", path, &text);
}

static void add_sources(struct generation *g)
{
    const struct model *model = &g->model;
    struct text header = {0}, pipeline = {0}, gl = {0}, vk = {0}, gl_shaders = {0},
                vk_shaders = {0}, graph = {0}, lifetimes = {0};
    emit_header(model, &header);
    emit_c_pipeline(model, g->shaders[BACKEND_VK], &pipeline);
    emit_c_gl(model, g->shaders[BACKEND_GL], &gl);
    emit_c_shaders(model, g->shaders[BACKEND_GL], BACKEND_GL, &gl_shaders);
    emit_c_shaders(model, g->shaders[BACKEND_VK], BACKEND_VK, &vk_shaders);
    emit_c_vk(model, g->shaders[BACKEND_VK], &vk);
    emit_graph(model, &graph);
    emit_lifetimes(model, &lifetimes);
    struct text *const long_lined[] = {&header, &pipeline, &gl, &vk};
    for (size_t i = 0; i < sizeof long_lined / sizeof *long_lined; i++)
        text_wrap(long_lined[i], GENERATED_COLUMNS);
    add_named(g, ".h", &header);
    add_named(g, ".c", &pipeline);
    add_named(g, "_gl.c", &gl);
    add_named(g, "_gl_shaders.c", &gl_shaders);
    add_named(g, "_vk.c", &vk);
    add_named(g, "_vk_shaders.c", &vk_shaders);
    add_named(g, ".dot", &graph);
    add_named(g, "_lifetimes.dot", &lifetimes);
    add_shaders(g);
    add_limits(g);
}

/* Before the sources, which take the GLSL. */
static void add_cache(struct generation *g)
{
    struct text text = {0};
    shader_cache_emit(g->cache, &g->model, g->shaders, &text);
    output_add(g->output, "", g->options->shader_cache, &text);
}

static enum status write_files(struct generation *g)
{
    g->output = output_create();
    if (!g->output) {
        fputs("diptych-gen: error: out of memory\n", stderr);
        return STATUS_FAILED;
    }
    if (g->cache)
        add_cache(g);
    if (g->options->out)
        add_sources(g);
    if (g->options->graph)
        add_drawing(g, g->options->graph, emit_graph);
    if (g->options->lifetimes)
        add_drawing(g, g->options->lifetimes, emit_lifetimes);
    if (g->options->depfile)
        add_depfile(g);
    return output_commit(g->output) ? STATUS_DONE : STATUS_FAILED;
}

static void print_summary(const struct pipeline *pipeline)
{
    const double mebi = 1024.0 * 1024.0;
    double whole = (double)pipeline->transient_bytes / mebi,
           aliased = (double)pipeline->aliased_bytes / mebi;
    printf("%s: %u passes, %u resources; transients at 1920x1080: %.1f MiB, with aliasing %.1f MiB",
           pipeline->name, pipeline->pass_count, pipeline->resource_count, whole, aliased);
    if (whole > 0)
        printf(" (%.0f %% saved)", 100 * (1 - aliased / whole));
    printf("\n");
}

static enum status generate(struct generation *g)
{
    const struct options *options = g->options;
    if (!read_spec(&g->model, options->spec, options->sets, options->set_count, g->diag) ||
        !check_model(&g->model, g->model.templates_dir, g->diag) || diag_error_count(g->diag))
        return STATUS_WRONG_SPEC;
    g->model.pipeline.for_edits = options->edits;
    layout_model(&g->model);
    if (!plan_model(&g->model, g->diag) || diag_error_count(g->diag))
        return STATUS_WRONG_SPEC;
    g->cache = options->shader_cache ? shader_cache_read(options->shader_cache) : NULL;
    if (!shaders_compile(&g->model, g->shaders, g->cache, g->diag))
        return STATUS_WRONG_SPEC;
    enum status status = options->check ? STATUS_DONE : write_files(g);
    if (status == STATUS_DONE)
        print_summary(&g->model.pipeline);
    return status;
}

/* Asked before the overrides of parameters are sorted into live and baked, so nothing is checked. */
static enum status print_live(struct generation *g)
{
    const struct options *options = g->options;
    if (!read_spec(&g->model, options->spec, options->sets, options->set_count, g->diag) ||
        diag_error_count(g->diag))
        return STATUS_WRONG_SPEC;
    for (uint32_t i = 0; i < g->model.pipeline.param_count; i++)
        if (g->model.pipeline.params[i].live)
            puts(g->model.pipeline.params[i].name);
    return STATUS_DONE;
}

/* A whole number, or `otherwise` without text; false, reported, when it is none from least to most. */
static bool read_number(const char *name, const char *text, uint64_t least, uint64_t most,
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

static enum status print_variations(struct generation *g)
{
    const struct options *options = g->options;
    struct text text = {0};
    uint64_t count, seed, memory;
    if (!read_number("--variations", options->variations, 0, 1000000, 1, &count) ||
        !read_number("--seed", options->seed, 0, UINT64_MAX, 1, &seed) ||
        !read_number("--memory", options->memory, 1, 1 << 20, 64, &memory))
        return STATUS_FAILED;
    struct vary_request request = {.spec = options->spec,
                                   .templates_dir = g->model.templates_dir,
                                   .sets = options->sets,
                                   .set_count = options->set_count,
                                   .count = (uint32_t)count,
                                   .seed = seed,
                                   .bytes = memory << 20};
    bool good = vary(&request, &text, g->diag);
    if (good && fwrite(text.data, 1, text.length, stdout) != text.length)
        good = false;
    text_free(&text);
    return good ? STATUS_DONE : STATUS_WRONG_SPEC;
}

/* `templates` in the working folder, else beside the program's folder: build/diptych-gen finds
 * templates/, bin/diptych-gen of an installation share/diptych/templates. */
static const char *find_templates(struct arena *arena, const char *given)
{
    char program[PATH_MAX];
    if (given)
        return given;
    if (!access("templates/glsl", R_OK))
        return "templates";
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    if (length <= 0)
        return "templates";
    program[length] = '\0';
    for (int i = 0; i < 2; i++) {
        char *slash = strrchr(program, '/');
        if (slash)
            *slash = '\0';
    }
    const char *path = arena_printf(arena, "%s/share/diptych/templates", program);
    const char *glsl = arena_printf(arena, "%s/glsl", path ? path : "");
    if (!glsl || access(glsl, R_OK) != 0)
        path = arena_printf(arena, "%s/templates", program);
    return path ? path : "templates";
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

/* The shape that `diptych VERB --json` has; written also, and above all, when the spec is wrong. */
static enum status write_json(const struct generation *g, enum status status)
{
    struct output *output = output_create();
    struct text text = {0};
    text_add(&text,
             "{\n  \"verb\": \"%s\",\n  \"format\": 1,\n  \"exit_status\": %d,\n  \"errors\": ",
             g->options->check ? "check" : "generate", (int)status);
    diag_json(g->diag, &text);
    if (status == STATUS_DONE)
        add_summary_json(&g->model, &text);
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

/* `waits`: there is time to prepare for OpenGL, too, which is of use where the helper fails. */
static bool start_compiler(bool waits)
{
    bool helped = helper_start(BACKEND_GL);
    if (spirv_init(BACKEND_VK, helped && !waits ? BACKEND_VK : BACKEND_GL))
        return true;
    helper_stop();
    return false;
}

static void stop_compiler(void)
{
    helper_stop();
    spirv_finish();
}

static enum status run(const struct options *options)
{
    struct generation g = {
        .options = options, .diag = diag_create(), .model.arena = arena_create()};
    enum status status = STATUS_FAILED;
    bool starts = !options->live && !options->started, started = starts && start_compiler(false);
    if (starts && !started) {
        fputs("diptych-gen: error: the GLSL compiler could not be started\n", stderr);
    } else if (g.diag && g.model.arena) {
        g.model.templates_dir = find_templates(g.model.arena, options->templates);
        status = options->live         ? print_live(&g)
                 : options->variations ? print_variations(&g)
                                       : generate(&g);
        fflush(stdout);
        if (options->json)
            status = write_json(&g, status);
        diag_flush(g.diag);
    } else {
        fputs("diptych-gen: error: out of memory\n", stderr);
    }
    shaders_free(&g.model, g.shaders);
    shader_cache_free(g.cache);
    output_free(g.output);
    diag_free(g.diag);
    arena_free(g.model.arena);
    if (started)
        stop_compiler();
    return status;
}

static enum status print_text(void (*emit)(struct text *out))
{
    struct text text = {0};
    emit(&text);
    bool good =
        !text.failed && (!text.length || fwrite(text.data, 1, text.length, stdout) == text.length);
    good = !fflush(stdout) && good;
    if (!good)
        fprintf(stderr, "diptych-gen: error: cannot write to the standard output: %s\n",
                strerror(errno));
    text_free(&text);
    return good ? STATUS_DONE : STATUS_FAILED;
}

/* ---- The command line ------------------------------------------------------------------------ */

static enum status run_words(int argc, char **argv, bool started)
{
    struct options options = {.sets = calloc((size_t)argc + 1, sizeof(char *)), .started = started};
    enum status status = STATUS_DONE;
    if (!options.sets || !parse_options(argc, argv, &options)) {
        status = STATUS_FAILED;
    } else if (options.help) {
        print_help();
    } else if (options.version) {
        printf("diptych-gen " VERSION "\n"); /* as build.ninja has it */
    } else if (options.schema) {
        status = print_text(emit_schema);
    } else if (options.reference) {
        status = print_text(emit_reference);
    } else {
        status = run(&options);
    }
    free(options.sets);
    return status;
}

/* What comes on the standard input, up to its end; NULL when it cannot be read. */
static char *read_input(size_t *size)
{
    size_t capacity = 4096;
    char *bytes = malloc(capacity);
    *size = 0;
    while (bytes) {
        ssize_t got = read(STDIN_FILENO, bytes + *size, capacity - *size);
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            break;
        *size += (size_t)got;
        char *grown = *size == capacity ? realloc(bytes, capacity *= 2) : bytes;
        if (!grown)
            free(bytes);
        bytes = grown;
    }
    return bytes;
}

/* --wait: for programs that will want a generation soon (app/base/tool.h). Prepares the GLSL compiler, which is
 * most of the work of a small edit, and takes its words from the standard input, each ended by a zero
 * byte; none: it was not wanted after all. */
static enum status wait_and_run(void)
{
    bool started = start_compiler(true);
    size_t size = 0;
    char *words = started ? read_input(&size) : NULL;
    char **argv = calloc(size + 2, sizeof *argv);
    int argc = 1;
    for (size_t at = 0; words && argv && at < size; at += strlen(words + at) + 1) {
        if (words[size - 1]) /* cut short */
            break;
        argv[argc++] = words + at;
    }
    enum status status = argc > 1 ? run_words(argc, argv, true) : STATUS_DONE;
    if (started)
        stop_compiler();
    free(argv);
    free(words);
    return status;
}

int main(int argc, char **argv)
{
    if (argc == 2 && !strcmp(argv[1], "--describe")) {
        print_description();
        return STATUS_DONE;
    }
    if (argc == 2 && !strcmp(argv[1], "--wait"))
        return (int)wait_and_run();
    return (int)run_words(argc, argv, false);
}
