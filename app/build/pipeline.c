/* Loads pipelines; see pipeline.h. */
#include "build/pipeline.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/files.h"
#include "base/live.h"
#include "base/tool.h"

/* Processor time after which a spec hangs. */
#define TRY_SECONDS "30"

/* What a load needs, found from the options. */
struct load {
    char *tools, *spec, *templates, *cache;
    const char **sets; /* those of no live parameter, sorted */
    uint32_t set_count;
    const char *root;
};

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

/* ---- Cache ----------------------------------------------------------------------------------- */

static bool is_writable(const char *folder)
{
    struct stat info;
    return access(folder, W_OK) == 0 && stat(folder, &info) == 0 && S_ISDIR(info.st_mode);
}

/* BASE/NAME where BASE is there, or can be made, and written; else NULL. */
static char *folder_in(const char *base, const char *name)
{
    char *folder = base && *base == '/' ? format_string("%s%s", base, name) : NULL;
    if (base && *base == '/' && mkdir(base, 0700) == 0)
        return folder;
    if (folder && (is_writable(folder) || (access(folder, F_OK) != 0 && is_writable(base))))
        return folder;
    free(folder);
    return NULL;
}

/* build/cache where that can be written, else the user's own cache folder, as for what is installed. NULL:
 * neither can; then there is no cache. */
static char *cache_folder(const char *tools)
{
    const char *home = getenv("HOME");
    char *own = home ? format_string("%s/.cache", home) : NULL;
    char *folder = tools_installed(tools) ? NULL : folder_in(tools, "/cache");
    folder = folder ? folder : folder_in(getenv("XDG_CACHE_HOME"), "/diptych");
    folder = folder ? folder : folder_in(own, "/diptych");
    free(own);
    return folder;
}

/* ---- Overrides ------------------------------------------------------------------------------- */

/* A bare name is a parameter or a top-level key, everything else (dots, brackets) a path in the
 * spec. */
static bool is_bare(const char *set)
{
    return strcspn(set, ".[") > strcspn(set, "=");
}

static int compare_strings(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

static struct plan_request request_of(const struct load *load)
{
    return (struct plan_request){.spec = load->spec,
                                 .templates = load->templates,
                                 .sets = load->sets,
                                 .set_count = load->set_count,
                                 .cache = load->cache,
                                 .root = load->root};
}

/* Those of live parameters are left out. Names that the spec does not know stay: planning judges them. */
static bool sort_sets(struct load *load, const struct options *options, struct console *console)
{
    bool *live = calloc(options->set_count + 1, sizeof *live);
    bool good = live && load->sets;
    for (uint32_t i = 0; good && i < options->set_count; i++)
        if (!is_bare(options->sets[i]))
            load->sets[load->set_count++] = options->sets[i];
    if (!good) {
        report_error(&console->log, "out of memory");
    } else if (load->set_count < options->set_count) {
        struct plan_request request = request_of(load);
        good = plan_find_live(&request, (const char *const *)options->sets, options->set_count,
                              live, console);
        for (uint32_t i = 0; good && i < options->set_count; i++)
            if (is_bare(options->sets[i]) && !live[i])
                load->sets[load->set_count++] = options->sets[i];
    }
    if (good)
        qsort(load->sets, load->set_count, sizeof *load->sets, compare_strings);
    free(live);
    return good;
}

static bool set_live(struct pipeline *pipeline, const struct options *options,
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

/* ---- Load ------------------------------------------------------------------------------------ */

static bool find(struct load *load, struct console *console, const struct options *options)
{
    const struct dt_log *log = &console->log;
    *load = (struct load){.sets = calloc(options->set_count + 1, sizeof *load->sets),
                          .root = options->root};
    load->tools = tools_folder(log);
    load->spec = load->tools ? pipeline_spec_path(options->spec, log) : NULL;
    load->templates = !load->spec          ? NULL
                      : options->templates ? realpath(options->templates, NULL)
                                           : templates_folder(log);
    load->cache = load->tools ? cache_folder(load->tools) : NULL;
    if (load->spec && !load->templates)
        report_error(log, "%s: cannot be read: %s",
                     options->templates ? options->templates : "templates", strerror(errno));
    return load->templates && sort_sets(load, options, console);
}

static void forget(struct load *load)
{
    free(load->sets);
    free(load->cache);
    free(load->templates);
    free(load->spec);
    free(load->tools);
}

static bool take_plan(struct pipeline *pipeline, struct load *load, const struct options *options,
                      const struct dt_log *log)
{
    pipeline->info = plan_pipeline(pipeline->plan);
    pipeline->gl = plan_shaders(pipeline->plan, "gl");
    pipeline->vk = plan_shaders(pipeline->plan, "vk");
    pipeline->live = malloc(pipeline->info->live_size);
    if (!pipeline->live) {
        report_error(log, "out of memory");
        return false;
    }
    memcpy(pipeline->live, pipeline->info->live_defaults, pipeline->info->live_size);
    pipeline->spec = load->spec;
    pipeline->templates = load->templates;
    load->spec = load->templates = NULL;
    return set_live(pipeline, options, log);
}

bool pipeline_load(struct pipeline *pipeline, struct console *console,
                   const struct options *options)
{
    struct load load;
    *pipeline = (struct pipeline){0};
    bool good = find(&load, console, options);
    if (good) {
        struct plan_request request = request_of(&load);
        console_status(console, "planning %s", load.spec);
        pipeline->plan = plan_load(&request, console);
        good = pipeline->plan && take_plan(pipeline, &load, options, &console->log);
    }
    forget(&load);
    if (!good)
        pipeline_unload(pipeline);
    return good;
}

static bool run_generator(const struct load *load, struct console *console)
{
    static const struct tool generator = {
        .what = "reading the spec", .hint = "build the project with ninja", .explains = true};
    char *tool = format_string("%s/diptych-gen", load->tools);
    char **argv = calloc(load->set_count * 2 + 12, sizeof *argv);
    bool good = false;
    if (tool && argv) {
        const char *const words[] = {
            tool,        load->spec,    "--check",       "--limit",
            TRY_SECONDS, "--templates", load->templates, load->cache ? "--cache" : NULL,
            load->cache};
        size_t n = 0;
        for (size_t i = 0; i < DT_ARRAY_COUNT(words); i++)
            if (words[i])
                argv[n++] = (char *)words[i];
        for (uint32_t i = 0; i < load->set_count; i++) {
            argv[n++] = (char *)"--set";
            argv[n++] = (char *)load->sets[i];
        }
        good = tool_run(&generator, argv, -1, console);
    } else {
        report_error(&console->log, "out of memory");
    }
    free(argv);
    free(tool);
    return good;
}

/* Sorting the overrides reads the spec in this process; so all of them go to the other one first, where a
 * live parameter's does no harm. */
bool pipeline_try(struct console *console, const struct options *options)
{
    const struct dt_log *log = &console->log;
    struct load load = {.sets = (const char **)options->sets, .set_count = options->set_count};
    load.tools = tools_folder(log);
    load.spec = load.tools ? pipeline_spec_path(options->spec, log) : NULL;
    load.templates =
        load.spec ? options->templates ? realpath(options->templates, NULL) : templates_folder(log)
                  : NULL;
    load.cache = load.tools ? cache_folder(load.tools) : NULL;
    bool good = load.templates && run_generator(&load, console);
    load.sets = NULL;
    forget(&load);
    return good;
}

void pipeline_unload(struct pipeline *pipeline)
{
    free(pipeline->live);
    free(pipeline->templates);
    free(pipeline->spec);
    plan_free(pipeline->plan);
    *pipeline = (struct pipeline){0};
}
