/* The app's way into gen/; see plan.h. */
#include "spec/plan.h"

#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

#include "base/files.h"
#include "spec/play.h"
#include "gen/read/body_files.h"
#include "gen/load.h"
#include "gen/print/print.h"
#include "gen/plan/sanitize.h"
#include "gen/model/cross.h"
#include "gen/spirv/passes.h"
#include "gen/spirv/watchdog.h"

struct plan {
    struct spec spec;
    struct spec_request request; /* with strings of its own, for plan_for_gpu */
    struct plan *gpu;            /* owned; NULL: not asked for */
};

/* ---- Load ------------------------------------------------------------------------------------ */

static char *copy_of(const char *text)
{
    return text ? strdup(text) : NULL;
}

static void forget_request(struct spec_request *request)
{
    for (size_t i = 0; request->sets && i < request->set_count; i++)
        free((char *)request->sets[i]);
    free((void *)request->sets);
    free((char *)request->path);
    free((char *)request->templates);
    free((char *)request->root);
    free((char *)request->cache);
}

/* False when out of memory; forget_request in any case. */
static bool keep_request(struct spec_request *kept, const struct spec_request *request)
{
    const char **sets = calloc(request->set_count + 1, sizeof *sets);
    *kept = *request;
    kept->sets = sets;
    kept->path = copy_of(request->path);
    kept->templates = copy_of(request->templates);
    kept->root = copy_of(request->root);
    kept->cache = copy_of(request->cache);
    bool good = sets && kept->path && kept->templates && !request->root == !kept->root &&
                !request->cache == !kept->cache;
    for (size_t i = 0; sets && i < request->set_count; i++)
        good = (sets[i] = copy_of(request->sets[i])) && good;
    return good;
}

static struct plan *load(const struct spec_request *wanted, struct console *console)
{
    struct plan *plan = calloc(1, sizeof *plan);
    struct diag *diag = diag_create();
    bool good = plan && diag && keep_request(&plan->request, wanted);
    if (good) {
        /* the library has no limits: they would end its host */
        bool limited = !console->attached && watchdog_start(SPEC_SECONDS, console->failed);
        good = spec_load(&plan->spec, wanted, true, diag);
        if (limited)
            watchdog_stop();
        diag_report(diag, &console->log);
    } else {
        report_error(&console->log, "out of memory");
    }
    diag_free(diag);
    if (good) {
        play_prepare(plan->spec.tables);
        return plan;
    }
    plan_free(plan);
    return NULL;
}

struct plan *plan_load(struct spec_request request, struct console *console)
{
    request.codes = true;
    return load(&request, console);
}

bool plan_is_automatic(const struct plan *plan)
{
    return plan->spec.model.pipeline.automatic;
}

struct plan *plan_for_gpu(struct plan *plan, struct console *console)
{
    struct spec_request wanted = plan->request;
    wanted.gpu = true;
    if (plan->request.gpu)
        return plan;
    if (!plan->gpu)
        plan->gpu = load(&wanted, console);
    return plan->gpu;
}

void plan_free(struct plan *plan)
{
    if (!plan)
        return;
    plan_free(plan->gpu);
    spec_free(&plan->spec);
    forget_request(&plan->request);
    free(plan);
}

const struct dt_pipeline *plan_pipeline(const struct plan *plan)
{
    return &plan->spec.tables->pipeline;
}

static enum backend backend_of(const char *name)
{
    return strcmp(name, "gl") == 0 ? BACKEND_GL : BACKEND_VK;
}

const struct dt_shaders *plan_shaders(const struct plan *plan, const char *backend)
{
    return &plan->spec.tables->shaders[backend_of(backend)];
}

const char *const *plan_sources(const struct plan *plan, uint32_t *count)
{
    *count = plan->spec.model.input_count;
    return plan->spec.model.inputs;
}

bool plan_glsl(struct plan *plan, const char *backend, uint32_t pass, int stage, const char **glsl)
{
    struct shader *shader = &plan->spec.shaders[backend_of(backend)][pass].stage[stage];
    bool good = true;
    if (shader->word_count && !shader->glsl.length) { /* loaded without OpenGL's text */
        char *why = NULL;
        good = spirv_cross(shader->words, shader->word_count, &shader->glsl, &why);
        free(why);
    }
    *glsl = shader->glsl.data;
    return good;
}

uint64_t plan_operations(const struct plan *plan)
{
    uint64_t sum = 0, loops;
    for (uint32_t i = 0; i < 3 * plan_pipeline(plan)->pass_count; i++) {
        const struct shader *shader = &plan->spec.shaders[BACKEND_VK][i / 3].stage[i % 3];
        struct spirv module;
        if (!shader->word_count || !spirv_open(&module, shader->words, shader->word_count))
            continue;
        sum += spirv_operations(&module, &loops);
        spirv_free(&module);
    }
    return sum;
}

struct plan_work plan_work(const struct plan *plan, uint32_t pass, const uint32_t size[2],
                           const void *live)
{
    const struct steps *steps = &plan->spec.tables->passes[pass].steps;
    const struct step *called = steps_work(steps);
    struct plan_work work = {.verb = dt_verb_info(called->verb)};
    for (const struct step *step = steps->list; step < steps->list + steps->count; step++) {
        int64_t a[4];
        for (int i = 0; i < 4; i++)
            a[i] = amount_value(&step->arguments[i], size[0], size[1], live);
        if (step == called)
            memcpy(work.arguments, a, sizeof a);
        if (step->verb == DT_VERB_BEGIN)
            work.runs = a[0];
        if (step->verb != DT_VERB_VIEWPORT && step->verb != DT_VERB_SCISSOR)
            continue;
        work.has_area = true;
        work.area = dt_make_rect(a[0], a[1], a[2], a[3]);
    }
    return work;
}

struct plan_input plan_input(const struct plan *plan, uint32_t resource)
{
    const struct resource *of = &plan->spec.model.pipeline.resources[resource];
    return (struct plan_input){
        .file = of->file_path, .srgb = of->srgb, .encoding_is_given = of->encoding_is_given};
}

void plan_blame_file(const struct plan *plan, uint32_t resource, const char *text,
                     struct console *console)
{
    report_at(&console->log, plan->spec.model.pipeline.resources[resource].file_loc, "%s", text);
}

/* ---- Choices --------------------------------------------------------------------------------- */

struct chooser {
    bool (*take)(void *user, uint32_t pass, const char *path, const char *value);
    void *user;
    uint32_t pass;
};

/* All words but the one in force. Frees the path. */
static bool choose(const struct chooser *chooser, char *path, const char *const *words,
                   const char *in_force)
{
    bool good = path;
    for (; *words && good; words++)
        good = strcmp(*words, in_force) == 0 ||
               chooser->take(chooser->user, chooser->pass, path, *words);
    free(path);
    return good;
}

static bool choose_range(const struct chooser *chooser, const struct pass *pass,
                         const struct range *range)
{
    static const char *const storages[] = {"shared", "buffer", "uniform", NULL}, *const loops[] = {
                                                                                     "unroll",
                                                                                     "roll", NULL};
    static const char *const storage_names[] = {[STORAGE_AUTO] = "",
                                                [STORAGE_SHARED] = "shared",
                                                [STORAGE_BUFFER] = "buffer",
                                                [STORAGE_UNIFORM] = "uniform"},
                             *const loop_names[] = {
                                 [LOOP_AUTO] = "", [LOOP_UNROLL] = "unroll", [LOOP_ROLL] = "roll"};
    const char *const format = "passes.%s.ranges.%s.%s";
    return choose(chooser, format_string(format, pass->name, range->name, "storage"), storages,
                  storage_names[range->storage]) &&
           choose(chooser, format_string(format, pass->name, range->name, "loop"), loops,
                  loop_names[range->loop]);
}

/* Of dispatches of invocations, whose workgroups are only their number. */
static bool choose_local(const struct chooser *chooser, const struct pass *pass)
{
    static const char *const lines[] = {"32", "64", "128", "256", "512", NULL},
                             *const planes[] = {"[8,8]",  "[16,8]", "[32,4]", "[64,2]",  "[16,16]",
                                                "[32,8]", "[64,4]", "[64,8]", "[32,16]", NULL};
    char in_force[32];
    bool line = pass->size == SIZE_INVOCATIONS && !pass->dispatch[1];
    if (pass->kind != DT_PASS_DISPATCH || pass->minds_group || pass->size == SIZE_GROUPS ||
        pass->size == SIZE_INDIRECT)
        return true;
    snprintf(in_force, sizeof in_force, line ? "%u" : "[%u,%u]", pass->local[0], pass->local[1]);
    return choose(chooser, format_string("passes.%s.local", pass->name), line ? lines : planes,
                  in_force);
}

bool plan_choices(const struct plan *plan,
                  bool (*take)(void *user, uint32_t pass, const char *path, const char *value),
                  void *user)
{
    const struct pipeline *pipeline = &plan->spec.model.pipeline;
    bool good = true;
    for (uint32_t i = 0; i < pipeline->pass_count && good; i++) {
        const struct pass *pass = pipeline->order[i];
        const struct chooser chooser = {take, user, i};
        for (uint32_t k = 0; k < pass->range_count && good; k++)
            good = choose_range(&chooser, pass, &pass->ranges[k]);
        good = good && choose_local(&chooser, pass);
    }
    return good;
}

bool plan_is_bounded(const struct plan *plan, uint32_t pass)
{
    return plan->spec.model.pipeline.order[pass]->bounded;
}

uint32_t plan_group(const struct plan *plan, uint32_t pass)
{
    const struct pass *of = plan->spec.model.pipeline.order[pass];
    return of->kind == DT_PASS_DISPATCH ? of->local[0] * of->local[1] * of->local[2] : 1;
}

uint32_t plan_reports(const struct plan *plan)
{
    const struct pipeline *pipeline = &plan->spec.model.pipeline;
    uint32_t first = pipeline->resource_count;
    while (first && pipeline->resources[first - 1].internal)
        first--;
    return first;
}

bool plan_undefined(const struct plan *plan, const void *bytes, uint64_t size,
                    struct dt_finding **findings, uint32_t *count)
{
    return sanitize_read(&plan->spec.model, &plan->spec.tables->pipeline, bytes, size, findings,
                         count);
}

void plan_warn_idle(const struct plan *plan, struct console *console)
{
    struct diag *diag = diag_create();
    if (diag) {
        sanitize_warn_idle(&plan->spec.model, diag);
        diag_report(diag, &console->log);
    } else {
        report_error(&console->log, "out of memory");
    }
    diag_free(diag);
}

uint64_t plan_hash(const struct plan *plan)
{
    const struct spec *spec = &plan->spec;
    struct text text = {0};
    emit_c_panel(spec->tables, &text);
    for (uint32_t i = 0; i < spec->model.pipeline.pass_count; i++)
        for (int stage = 0; stage < 3; stage++)
            for (int backend = 0; backend < 2; backend++) {
                const struct shader *shader = &spec->shaders[backend][i].stage[stage];
                /* OpenGL's text, which not every plan has, follows from these */
                const struct text *code = backend == BACKEND_GL ? &shader->code : &shader->glsl;
                text_add_bytes(&text, code->data ? code->data : "", code->length);
                for (uint32_t k = 1; shader->files && k < shader->files->count; k++)
                    text_add(&text, "%s", shader->files->list[k].code);
            }
    uint64_t hash = text.failed ? 0 : XXH3_64bits(text.data, text.length);
    for (uint32_t i = 0; hash && i < spec->model.pipeline.resource_count; i++)
        if (spec->model.pipeline.resources[i].file_path)
            hash_file(&hash, spec->model.pipeline.resources[i].file_path);
    text_free(&text);
    return hash;
}
