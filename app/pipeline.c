/* Loads pipelines and sets their live parameters; see pipeline.h. */
#include "pipeline.h"

#include <dlfcn.h>
#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cache.h"
#include "files.h"
#include "texels.h"
#include "tool.h"

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

const struct dt_param *pipeline_param(const struct dt_pipeline *info, const char *name)
{
    for (uint32_t i = 0; i < info->param_count; i++) {
        if (strcmp(info->params[i].name, name) == 0)
            return &info->params[i];
    }
    return NULL;
}

/* Reads "1.5", "true" or "[1, 2]" into values; false unless it is exactly `count` of them. */
static bool read_values(const char *text, uint32_t count, double *values)
{
    bool list = *text == '[';
    const char *at = list ? text + 1 : text;
    for (uint32_t i = 0; i < count; i++) {
        at += strspn(at, " ");
        char *end = NULL;
        values[i] = strtod(at, &end);
        if (end == at && strncmp(at, "true", 4) == 0) {
            values[i] = 1;
            end += 4;
        } else if (end == at && strncmp(at, "false", 5) == 0) {
            values[i] = 0;
            end += 5;
        }
        if (end == at || !isfinite(values[i]))
            return false;
        at = end + strspn(end, " ");
        if (i + 1 < count && *at++ != ',')
            return false;
    }
    if (list && *at++ != ']')
        return false;
    return *at == 0 && (list || count == 1);
}

static bool fits(const struct dt_param *param, enum dt_type scalar, double value)
{
    if (value < param->min || value > param->max)
        return false;
    if (scalar == DT_TYPE_INT)
        return value == floor(value) && value >= INT32_MIN && value <= INT32_MAX;
    if (scalar == DT_TYPE_UINT)
        return value == floor(value) && value >= 0 && value <= UINT32_MAX;
    return scalar == DT_TYPE_BOOL ? value == 0 || value == 1 : fabs(value) <= FLT_MAX;
}

static void write_scalar(uint8_t *place, enum dt_type scalar, double value)
{
    float number = (float)value;
    int32_t whole = scalar == DT_TYPE_INT ? (int32_t)value : 0;
    uint32_t natural = scalar == DT_TYPE_UINT || scalar == DT_TYPE_BOOL ? (uint32_t)value : 0;
    if (scalar == DT_TYPE_FLOAT)
        memcpy(place, &number, sizeof number);
    else if (scalar == DT_TYPE_INT)
        memcpy(place, &whole, sizeof whole);
    else
        memcpy(place, &natural, sizeof natural);
}

bool pipeline_set_live(struct pipeline *pipeline, const struct dt_param *param, const char *value,
                       const struct dt_log *log)
{
    enum dt_type scalar = type_scalar(param->type);
    uint32_t count = type_components(param->type);
    double values[16];
    if (count > 4 || param->offset + count * 4 > pipeline->info->live_size ||
        !read_values(value, count, values)) {
        report_error(log, "--set %s=%s: must be %s%s", param->name, value,
                     count > 1 ? "a list like [1, 2] of type " : "of type ",
                     type_name(param->type));
        return false;
    }
    for (uint32_t i = 0; i < count; i++) {
        if (!fits(param, scalar, values[i])) {
            report_error(log, "--set %s=%s: must be of type %s, from %g to %g", param->name, value,
                         type_name(param->type), param->min, param->max);
            return false;
        }
    }
    for (uint32_t i = 0; i < count; i++)
        write_scalar((uint8_t *)pipeline->live + param->offset + i * 4, scalar, values[i]);
    return true;
}

void pipeline_get_live(const struct pipeline *pipeline, const struct dt_param *param,
                       double values[4])
{
    static const enum number_kind kinds[] = {[DT_TYPE_FLOAT] = NUMBER_FLOAT,
                                             [DT_TYPE_INT] = NUMBER_INT,
                                             [DT_TYPE_UINT] = NUMBER_UINT,
                                             [DT_TYPE_BOOL] = NUMBER_UINT};
    const uint8_t *place = (const uint8_t *)pipeline->live + param->offset;
    for (uint32_t i = 0; i < type_components(param->type) && i < 4; i++)
        values[i] = number_value(kinds[type_scalar(param->type)], place + i * 4);
}

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
        const struct dt_param *param = name ? pipeline_param(pipeline->info, name) : NULL;
        if (param && param->live && is_bare(options->sets[i]))
            good = pipeline_set_live(pipeline, param, value, log);
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
