/* Loads pipelines and sets their live parameters; see pipeline.h. */
#include "build/pipeline.h"

#include <dlfcn.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/files.h"
#include "base/live.h"
#include "base/tool.h"
#include "build/cache.h"

char *pipeline_spec_path(const char *spec, const struct dt_log *log)
{
    char *templates = spec ? NULL : templates_folder(log);
    char *own = templates ? format_string("%s/ssvp.yaml", templates) : NULL;
    const char *wanted = spec ? spec : own;
    char *path = wanted ? realpath(wanted, NULL) : NULL;
    if (!path)
        report_error(log, "%s: the spec cannot be read: %s", wanted ? wanted : "spec",
                     strerror(errno));
    free(own);
    free(templates);
    return path;
}

static int compare_strings(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

static const struct dt_panel *find_panel(void *object, const char *name, const char *backend,
                                         const struct dt_log *log)
{
    char *symbol = format_string("%s_%s", name, backend);
    const struct dt_panel *panel = symbol ? dlsym(object, symbol) : NULL;
    if (!panel)
        report_error(log, "the generated pipeline has no symbol %s", symbol ? symbol : backend);
    free(symbol);
    return panel;
}

/* One generation: the pipeline with exactly these overrides, live block at its defaults. Unload it
 * in any case. */
static bool load_with(struct pipeline *pipeline, struct console *console,
                      const struct build_request *request)
{
    *pipeline = (struct pipeline){0};
    struct cache_entry entry;
    if (!cache_get(&entry, request, console))
        return false;
    pipeline->object = dlopen(entry.object, RTLD_NOW | RTLD_LOCAL);
    if (!pipeline->object) {
        report_error(&console->log, "the compiled pipeline cannot be loaded: %s", dlerror());
    } else {
        pipeline->gl = find_panel(pipeline->object, entry.name, "gl", &console->log);
        pipeline->vk = find_panel(pipeline->object, entry.name, "vk", &console->log);
    }
    pipeline->generated = entry.folder;
    pipeline->held = entry.held;
    pipeline->generator_ms = entry.generator_ms;
    pipeline->compiler_ms = entry.compiler_ms;
    entry.folder = NULL;
    entry.held = NULL;
    cache_entry_free(&entry);
    if (pipeline->gl && pipeline->vk) {
        pipeline->info = pipeline->gl->pipeline;
        pipeline->live = malloc(pipeline->info->live_size);
        if (pipeline->live) {
            memcpy(pipeline->live, pipeline->info->live_defaults, pipeline->info->live_size);
            return true;
        }
        report_error(&console->log, "out of memory");
    }
    return false;
}

void pipeline_unload(struct pipeline *pipeline)
{
    free(pipeline->live);
    free(pipeline->generated);
    free(pipeline->templates);
    free(pipeline->spec);
    if (pipeline->object)
        dlclose(pipeline->object);
    if (pipeline->held)
        closedir(pipeline->held);
    *pipeline = (struct pipeline){0};
}

/* ---- Overrides ------------------------------------------------------------------------------- */

/* A bare name is a parameter or a top-level key, everything else (dots, brackets) a path in the
 * spec. */
static bool is_bare(const char *set)
{
    return strcspn(set, ".[") > strcspn(set, "=");
}

/* The names of the spec's live parameters, a line each, asked of the generator; free(). */
static char *live_names(struct console *console, const struct build_request *request)
{
    static const struct tool generator = {
        .what = "reading the spec", .hint = "build the project with ninja", .explains = true};
    char *tool = format_string("%s/diptych-gen", request->tools);
    char **argv = calloc(request->set_count * 2 + 4, sizeof *argv);
    char *names = NULL;
    if (tool && argv) {
        size_t n = 0;
        argv[n++] = tool;
        argv[n++] = (char *)request->spec;
        argv[n++] = (char *)"--live";
        for (uint32_t i = 0; i < request->set_count; i++) {
            argv[n++] = (char *)"--set";
            argv[n++] = (char *)request->sets[i];
        }
        names = tool_read(&generator, argv, console);
    } else {
        report_error(&console->log, "out of memory");
    }
    free(argv);
    free(tool);
    return names;
}

/* Whether the name that `set` begins with is one of the lines of `names`. */
static bool is_listed(const char *names, const char *set)
{
    size_t length = strcspn(set, "=");
    for (const char *at = names; *at; at += *at == '\n') {
        const char *name = at;
        at += strcspn(at, "\n");
        if ((size_t)(at - name) == length && strncmp(name, set, length) == 0)
            return true;
    }
    return false;
}

static bool set_live_ones(struct pipeline *pipeline, const struct options *options,
                          const struct dt_log *log)
{
    bool good = true;
    for (uint32_t i = 0; i < options->set_count && good; i++) {
        const char *value = strchr(options->sets[i], '=') + 1;
        char *name = strndup(options->sets[i], (size_t)(value - 1 - options->sets[i]));
        const struct dt_param *param = name ? live_param(pipeline->info, name) : NULL;
        if (param && param->live && is_bare(options->sets[i]))
            good = live_set(pipeline->info, pipeline->live, param, value, log);
        free(name);
    }
    return good;
}

/* The pipeline is generated with all overrides but those of live parameters, which are set in it. Names that
 * the spec does not know are the generator's to judge. */
static bool load_request(struct pipeline *pipeline, struct console *console,
                         const struct options *options, struct build_request *request)
{
    for (uint32_t i = 0; i < options->set_count; i++) {
        if (!is_bare(options->sets[i]))
            request->sets[request->set_count++] = options->sets[i];
    }
    if (request->set_count < options->set_count) {
        char *names = live_names(console, request);
        if (!names)
            return false;
        for (uint32_t i = 0; i < options->set_count; i++) {
            if (is_bare(options->sets[i]) && !is_listed(names, options->sets[i]))
                request->sets[request->set_count++] = options->sets[i];
        }
        free(names);
    }
    qsort(request->sets, request->set_count, sizeof *request->sets, compare_strings);
    return load_with(pipeline, console, request) && set_live_ones(pipeline, options, &console->log);
}

static bool load(struct pipeline *pipeline, struct console *console, const struct options *options,
                 bool edited, struct tool_waiting *generator)
{
    *pipeline = (struct pipeline){0};
    char *tools = tools_folder(&console->log);
    char *headers = tools ? headers_folder(&console->log) : NULL;
    char *runtimes = headers ? runtimes_folder(&console->log) : NULL;
    char *spec = runtimes ? pipeline_spec_path(options->spec, &console->log) : NULL;
    char *templates = !spec                ? NULL
                      : options->templates ? realpath(options->templates, NULL)
                                           : templates_folder(&console->log);
    const char **sets = calloc(options->set_count + 1, sizeof *sets);
    struct build_request request = {.headers = {headers, runtimes},
                                    .tools = tools,
                                    .templates = templates,
                                    .spec = spec,
                                    .sets = sets,
                                    .generator = generator,
                                    .edited = edited,
                                    .hurried = generator};
    if (spec && (!templates || !sets))
        report_error(&console->log, "%s: cannot be read: %s",
                     options->templates ? options->templates : "templates", strerror(errno));
    bool good = spec && templates && sets && load_request(pipeline, console, options, &request);
    pipeline->templates = templates;
    pipeline->spec = spec;
    if (!good)
        pipeline_unload(pipeline);
    free(sets);
    free(runtimes);
    free(headers);
    free(tools);
    return good;
}

bool pipeline_load(struct pipeline *pipeline, struct console *console,
                   const struct options *options)
{
    return load(pipeline, console, options, false, NULL);
}

bool pipeline_load_edited(struct pipeline *pipeline, struct console *console,
                          const struct options *options, struct tool_waiting *generator)
{
    return load(pipeline, console, options, true, generator);
}
