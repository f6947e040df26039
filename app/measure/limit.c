/* Compiles, checks and times passes in plain C; see limit.h. */
#include "measure/limit.h"

#include <dlfcn.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/files.h"
#include "console/texels.h"
#include "console/tool.h"
#include "front.h"
#include "run/worker.h"

/* ---- Compiling ------------------------------------------------------------------------------- */

static const char *compiler_name(void)
{
    const char *compiler = getenv("CC");
    return compiler && *compiler ? compiler : "cc";
}

static bool write_text(const char *folder, const char *name, const char *tail, const char *text,
                       const struct dt_log *log)
{
    char *path = format_string("%s/%s%s", folder, name, tail);
    bool good = path && text && file_write(path, text, strlen(text), log);
    if (!path || !text)
        report_error(log, "out of memory");
    free(path);
    return good;
}

/* NAME.h, and PASS.c for every pass. */
static bool write_sources(const struct limits *limits, const char *folder,
                          const struct pipeline *pipeline, const struct dt_log *log)
{
    char *header = plan_header(pipeline->plan);
    bool good = write_text(folder, pipeline->info->name, ".h", header, log);
    free(header);
    for (uint32_t i = 0; good && i < limits->count; i++) {
        char *text = plan_limit(pipeline->plan, limits->list[i].pass);
        good = write_text(folder, limits->info->passes[limits->list[i].pass].name, ".c", text, log);
        free(text);
    }
    return good;
}

/* argv of the compiler, with slots for the files of a pass; NULL when out of memory. All strings
 * but the first are owned. */
static char **compiler_arguments(const struct limits *limits, const char *folder,
                                 const char *headers)
{
    static const char *const flags[] = {"-std=gnu11", "-O3",   "-march=native", "-ffast-math",
                                        "-fopenmp",   "-fPIC", "-shared"};
    char **argv = calloc(DT_ARRAY_COUNT(flags) + limits->count + 8, sizeof *argv);
    size_t n = 0;
    bool good = argv;
    if (good)
        argv[n++] = (char *)compiler_name();
    for (size_t i = 0; i < DT_ARRAY_COUNT(flags) && good; i++)
        good = (argv[n++] = strdup(flags[i]));
    good = good && (argv[n++] = format_string("-I%s", folder));
    good = good && (argv[n++] = format_string("-I%s", headers));
    for (uint32_t i = 0; i < limits->count && good; i++)
        good = (argv[n++] = format_string("%s/%s.c", folder,
                                          limits->info->passes[limits->list[i].pass].name));
    good =
        good && (argv[n++] = strdup("-o")) && (argv[n++] = format_string("%s/limits.so", folder));
    if (good)
        return argv;
    for (size_t i = 1; argv && argv[i]; i++)
        free(argv[i]);
    free(argv);
    return NULL;
}

static bool compile(const struct limits *limits, struct console *console, const char *folder)
{
    static const struct tool c_compiler = {
        .what = "compiling the limits that the spec names",
        .hint = "install a C compiler, or name one in the environment variable CC"};
    char *headers = headers_folder(&console->log);
    char **argv = headers ? compiler_arguments(limits, folder, headers) : NULL;
    if (!argv && headers)
        report_error(&console->log, "out of memory");
    bool good = argv && tool_run(&c_compiler, argv, -1, console);
    for (size_t i = 1; argv && argv[i]; i++)
        free(argv[i]);
    free(argv);
    free(headers);
    return good;
}

/* Never unloaded: OpenMP's threads spin in its library for a while after the last loop. */
static bool open_object(struct limits *limits, const char *folder, const struct dt_log *log)
{
    char *object = format_string("%s/limits.so", folder);
    limits->object = object ? dlopen(object, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE) : NULL;
    if (!limits->object)
        report_error(log, "the compiled limits cannot be loaded: %s",
                     object ? dlerror() : "out of memory");
    free(object);
    return limits->object;
}

/* Compiles and loads in a temporary folder. mkdtemp makes it writable for this user only; it is
 * removed before the function returns. */
static bool load(struct limits *limits, struct console *console, const struct pipeline *pipeline)
{
    const struct dt_log *log = &console->log;
    const char *base = getenv("TMPDIR");
    char *folder = format_string("%s/diptych-XXXXXX", base && *base == '/' ? base : "/tmp");
    if (!folder || !mkdtemp(folder)) {
        report_error(log, "%s: cannot be made: %s", folder ? folder : "a folder", strerror(errno));
        free(folder);
        return false;
    }
    console_temporary(console, folder);
    console_status(console, "compiling the limits");
    /* OpenMP threads must sleep when idle: the backends need the processor */
    setenv("OMP_WAIT_POLICY", "passive", 0);
    bool good = write_sources(limits, folder, pipeline, log) && compile(limits, console, folder) &&
                open_object(limits, folder, log);
    file_remove_tree(folder);
    console_forget(console, folder);
    free(folder);
    return good;
}

static void *find(const struct limits *limits, const char *pass, const char *tail)
{
    char *name = format_string("limit_%s%s", pass, tail);
    void *symbol = name ? dlsym(limits->object, name) : NULL;
    free(name);
    return symbol;
}

/* Removes passes whose file has no code for this processor. */
static bool find_functions(struct limits *limits, const struct dt_log *log)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < limits->count; i++) {
        struct limit_pass *limit = &limits->list[i];
        const struct dt_pass *pass = &limits->info->passes[limit->pass];
        void *run = find(limits, pass->name, "");
        memcpy(&limit->run, &run, sizeof run);
        limit->tolerance = find(limits, pass->name, "_tolerance");
        if (run && !limit->tolerance) {
            report_error(log, "%s: defines limit_%s but no limit_%s_tolerance", pass->limit,
                         pass->name, pass->name);
            return false;
        }
        if (run)
            limits->list[kept++] = *limit;
        else
            report_message(log, DT_INFO, "%s: has no limit_%s for this processor", pass->limit,
                           pass->name);
    }
    limits->count = kept;
    return true;
}

static bool allocate(struct limits *limits, uint32_t frames)
{
    bool good = true;
    for (uint32_t i = 0; i < limits->count && good; i++) {
        struct limit_pass *limit = &limits->list[i];
        const size_t resources = limits->info->resource_count;
        limit->inputs = calloc(resources, sizeof *limit->inputs);
        limit->outputs = calloc(resources, sizeof *limit->outputs);
        limit->expected = calloc(resources, sizeof *limit->expected);
        limit->ms = calloc(frames, sizeof *limit->ms);
        good = limit->inputs && limit->outputs && limit->expected && limit->ms;
    }
    return good;
}

bool limits_open(struct limits *limits, struct console *console, const struct pipeline *pipeline,
                 uint32_t frames)
{
    const struct dt_pipeline *info = pipeline->info;
    *limits = (struct limits){.info = info};
    limits->list = calloc(info->pass_count + 1, sizeof *limits->list);
    for (uint32_t i = 0; limits->list && i < info->pass_count; i++)
        if (info->passes[i].limit)
            limits->list[limits->count++] = (struct limit_pass){.pass = i, .live = pipeline->live};
    if (limits->list && limits->count && !tool_is_there(compiler_name())) {
        report_message(&console->log, DT_INFO,
                       "no C compiler %s: passes are not held against their limits",
                       compiler_name());
        limits->count = 0;
    }
    if (limits->list && !limits->count)
        return true;
    if (limits->list &&
        (!load(limits, console, pipeline) || !find_functions(limits, &console->log)))
        return false;
    if (limits->list && allocate(limits, frames))
        return true;
    report_error(&console->log, "out of memory");
    return false;
}

static void limit_free(struct limit_pass *limit, uint32_t resources)
{
    struct dt_bytes *const lists[] = {limit->inputs, limit->outputs, limit->expected};
    for (size_t i = 0; i < DT_ARRAY_COUNT(lists); i++) {
        for (uint32_t k = 0; lists[i] && k < resources; k++)
            free(lists[i][k].data);
        free(lists[i]);
    }
    free(limit->ms);
}

void limits_close(struct limits *limits)
{
    for (uint32_t i = 0; i < limits->count; i++)
        limit_free(&limits->list[i], limits->info->resource_count);
    free(limits->list);
    if (limits->object)
        dlclose(limits->object);
    *limits = (struct limits){0};
}

/* ---- Inputs and results ---------------------------------------------------------------------- */

static bool take(struct worker *worker, struct dt_bytes *list, uint32_t resource)
{
    struct dt_bytes found;
    if (!worker_read(worker, resource, 0, &found))
        return false;
    list[resource] = found;
    list[resource].data = malloc(found.size);
    if (!list[resource].data) {
        report_error(&worker->info.session.console->log, "out of memory");
        return false;
    }
    memcpy(list[resource].data, found.data, found.size);
    return true;
}

/* At a stop before or after the pass: reads its inputs, or its outputs, and allocates outputs for
 * the C. */
static bool take_all(struct worker *worker, struct limit_pass *limit, const struct dt_pass *pass,
                     bool before)
{
    bool good = true;
    for (uint32_t i = 0; i < pass->read_count && before && good; i++)
        good = take(worker, limit->inputs, pass->reads[i]);
    for (uint32_t i = 0; i < pass->write_count && !before && good; i++)
        good = take(worker, limit->expected, pass->writes[i]) &&
               take(worker, limit->outputs, pass->writes[i]);
    for (uint32_t i = 0; i < pass->write_count && !before && good; i++)
        memset(limit->outputs[pass->writes[i]].data, 0, limit->outputs[pass->writes[i]].size);
    return good;
}

/* A pass that live parameters skip has no results to compare with. */
static bool drop_skipped(struct limits *limits, struct worker *worker)
{
    struct worker_measure measure;
    uint32_t kept = 0;
    if (!worker_measure(worker, &measure))
        return false;
    for (uint32_t i = 0; i < limits->count; i++)
        if (isnan(measure.pass_ms[limits->list[i].pass]))
            limit_free(&limits->list[i], limits->info->resource_count);
        else
            limits->list[kept++] = limits->list[i];
    limits->count = kept;
    return true;
}

/* Steps through the first frame. */
static bool take_frame(struct limits *limits, struct worker *worker)
{
    struct worker_place place;
    for (;;) {
        if (!worker_wait(worker, &place))
            return false;
        if (place.stop == WORKER_FINISHED)
            return true;
        if (place.stop == WORKER_FRAME_DONE && !drop_skipped(limits, worker))
            return false;
        bool before = place.stop == WORKER_BEFORE_PASS;
        for (uint32_t i = 0; i < limits->count && (before || place.stop == WORKER_AFTER_PASS);
             i++) {
            struct limit_pass *limit = &limits->list[i];
            if (limit->pass == place.pass &&
                !take_all(worker, limit, &limits->info->passes[place.pass], before))
                return false;
        }
        if (!worker_resume(worker, DT_RUN))
            return false;
    }
}

/* ---- The check ------------------------------------------------------------------------------- */

/* State shared by all compared numbers. */
struct tally {
    uint64_t numbers, outliers;
};

static double component_value(const struct component *component, const struct dt_bytes *bytes,
                              size_t element)
{
    return number_value(component->kind, bytes->data + element + component->offset);
}

static void compare_component(struct tally *tally, const struct component *component,
                              uint32_t stride, const struct dt_bytes *expected,
                              const struct dt_bytes *found, double relative)
{
    double mean = 0;
    for (size_t at = 0; at < expected->size; at += stride)
        mean += fabs(component_value(component, expected, at)) * stride / (double)expected->size;
    for (size_t at = 0; at < expected->size; at += stride) {
        double a = component_value(component, expected, at);
        double b = component_value(component, found, at);
        double scale = fmax(fmax(fabs(a), fabs(b)), mean);
        tally->numbers++;
        tally->outliers += !(fabs(a - b) <= relative * scale); /* NaN is one */
    }
}

static bool compare_resource(struct tally *tally, const struct limits *limits,
                             const struct limit_pass *limit, uint32_t resource)
{
    const struct dt_resource *info = &limits->info->resources[resource];
    struct component *components = NULL;
    uint32_t count = resource_components(info, &components);
    for (uint32_t i = 0; i < count; i++)
        compare_component(tally, &components[i], resource_stride(info), &limit->expected[resource],
                          &limit->outputs[resource], limit->tolerance->relative);
    free(components);
    return count;
}

static void run(const struct limit_pass *limit)
{
    limit->run(&(struct dt_limit){.frame = &limit->frame,
                                  .live = limit->live,
                                  .scene = limit->scene,
                                  .inputs = limit->inputs,
                                  .outputs = limit->outputs});
}

static bool check(const struct limits *limits, struct limit_pass *limit, const struct dt_log *log)
{
    const struct dt_pass *pass = &limits->info->passes[limit->pass];
    struct tally tally = {0};
    run(limit);
    for (uint32_t i = 0; i < pass->write_count; i++) {
        if (!compare_resource(&tally, limits, limit, pass->writes[i])) {
            report_error(log, "out of memory");
            return false;
        }
    }
    limit->outliers = tally.numbers ? (double)tally.outliers / (double)tally.numbers : 0;
    if (limit->outliers <= limit->tolerance->outliers)
        return true;
    report_error(log,
                 "%s: %.3g %% of the numbers differ by more than %.3g %% from those of pass %s; at "
                 "most %.3g %% may: it does not compute the same",
                 pass->limit, 100 * limit->outliers, 100 * limit->tolerance->relative, pass->name,
                 100 * limit->tolerance->outliers);
    return false;
}

bool limits_check(struct limits *limits, const struct session_info *session)
{
    struct worker_info info = {
        .session = *session, .frames = 1, .stops_before = limits->info->pass_count, .quiet = true};
    struct worker worker;
    if (!limits->count)
        return true;
    info.session.timing = true;
    bool good = worker_start(&worker, &info) && take_frame(limits, &worker);
    worker_close(&worker);
    for (uint32_t i = 0; i < limits->count && good; i++) {
        struct limit_pass *limit = &limits->list[i];
        const uint32_t *size = session->setup->size;
        limit->scene = &session->scene->data;
        memset(&limit->frame, 0, sizeof limit->frame);
        scene_frame(session->scene, size[0], size[1], &limit->frame);
        limit->frame.width = size[0];
        limit->frame.height = size[1];
        limit->frame.previous_camera = limit->frame.camera;
        limit->frame.first = 1;
        dt_front_jitter(session->pipeline->info, session->pipeline->live, &limit->frame);
        good = check(limits, limit, &session->console->log);
    }
    return good;
}

void limit_time(struct limit_pass *limit, uint32_t at)
{
    double start = milliseconds_now();
    run(limit);
    limit->ms[at] = milliseconds_now() - start;
}
