/* All shaders of a pipeline: GLSL and SPIR-V for every plan, pass, backend and stage. One thread emits
 * the text, since that changes the model. Meanwhile others compile the shaders that are not in the
 * cache. Most of OpenGL's are made of Vulkan's, which takes no time; then the threads make OpenGL's
 * GLSL, which is for people, and for drivers that take text. */
#include "shader_cache.h"
#include "compile.h"
#include "model/cross.h"
#include "plan/sanitize.h"
#include "values.h"
#include "watchdog.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MOST_THREADS = 8 };

struct job { /* one shader to compile, or OpenGL's text to make of it */
    const struct shader_plan *plan;
    const struct pass *pass;
    enum backend backend;
    struct shader *shader;
    const struct shader *twin; /* earlier shader with the same text or words, to copy; or NULL */
    char *why;                 /* it has no text */
    bool done;
};

struct jobs {
    struct job *list;
    bool texts; /* to make */
    pthread_t threads[MOST_THREADS];
    uint32_t thread_count;
    pthread_mutex_t lock; /* of what follows */
    pthread_cond_t more;
    uint32_t count, next; /* taken so far: those before `next` */
    bool complete;        /* no further jobs come */
};

static bool has_stage(const struct pass *pass, enum stage stage)
{
    return pass->kind == DT_PASS_DISPATCH ? stage == STAGE_IS_COMPUTE : stage != STAGE_IS_COMPUTE;
}

/* ---- Compiling ------------------------------------------------------------------------------- */

/* The next job to compile; NULL: none is left. */
static struct job *next_job(struct jobs *jobs)
{
    pthread_mutex_lock(&jobs->lock);
    while (jobs->next == jobs->count && !jobs->complete)
        pthread_cond_wait(&jobs->more, &jobs->lock);
    struct job *job = jobs->next < jobs->count ? &jobs->list[jobs->next++] : NULL;
    pthread_mutex_unlock(&jobs->lock);
    return job;
}

/* NULL: nothing was lost. */
static void *compile_some(void *user)
{
    struct jobs *jobs = user;
    for (struct job *job; (job = next_job(jobs));) {
        if (job->twin)
            continue;
        char label[256];
        snprintf(label, sizeof label, "%s (%s:%d: %s)", job->pass->name,
                 job->pass->shader_loc.source->path, job->pass->shader_loc.line, job->pass->shader);
        watchdog_begin(label);
        struct shader *shader = job->shader;
        job->done =
            jobs->texts
                ? spirv_cross(shader->words, shader->word_count, &shader->glsl, &job->why)
                : spirv_compile(job->plan->model, job->pass, job->backend, shader, NULL, NULL);
        if (job->plan->model->sanitize && !jobs->texts)
            sanitize_end_turn(job->plan->model, shader->turn);
        watchdog_end(label);
    }
    return memory_was_lost() ? jobs : NULL;
}

/* One thread for each processor but this one's. Without them, this one compiles all. */
static void start_threads(struct jobs *jobs)
{
    long others = sysconf(_SC_NPROCESSORS_ONLN) - 1;
    while (jobs->thread_count < MOST_THREADS && jobs->thread_count < others &&
           !pthread_create(&jobs->threads[jobs->thread_count], NULL, compile_some, jobs))
        jobs->thread_count++;
}

static bool add_job(struct jobs *jobs, struct job job)
{
    if (!spirv_init(job.shader->whole.length))
        return diag_error(job.plan->diag, (struct loc){0},
                          "the GLSL compiler could not be started: out of memory");
    pthread_mutex_lock(&jobs->lock);
    jobs->list[jobs->count++] = job;
    job.shader->turn = jobs->count;
    pthread_cond_signal(&jobs->more);
    pthread_mutex_unlock(&jobs->lock);
    if (jobs->count == 1)
        start_threads(jobs);
    return true;
}

static void compile_rest(struct jobs *jobs)
{
    pthread_mutex_lock(&jobs->lock);
    jobs->complete = true;
    pthread_cond_broadcast(&jobs->more);
    pthread_mutex_unlock(&jobs->lock);
    compile_some(jobs);
    for (uint32_t i = 0; i < jobs->thread_count; i++) {
        void *lost;
        if (!pthread_join(jobs->threads[i], &lost) && lost)
            memory_lost();
    }
}

/* ---- All ------------------------------------------------------------------------------------- */

/* An earlier shader with the same text. first: the first plan; NULL: this is. */
static const struct shader *twin_of(const struct shader_plan *first, const struct job *job,
                                    uint32_t index)
{
    const struct shader *twin = NULL;
    if (job->plan->model->sanitize)
        return NULL;
    if (first)
        twin = shader_twin(first->shaders[job->backend], first->model->pipeline.pass_count,
                           job->shader);
    return twin ? twin : shader_twin(job->plan->shaders[job->backend], index, job->shader);
}

/* Emits the GLSL of the pass `index`; adds jobs for shaders that are not in the cache. */
static bool emit_pass_shaders(const struct shader_plan *first, uint32_t index, struct cache *cache,
                              struct job job, struct jobs *jobs)
{
    struct model *model = job.plan->model;
    struct pass_shaders **shaders = job.plan->shaders;
    struct shader *list = shaders[job.backend][index].stage;
    bool good = true;
    for (enum stage stage = STAGE_IS_COMPUTE; stage <= STAGE_IS_FRAGMENT; stage++) {
        struct shader *shader = &list[stage];
        shader->stage = stage;
        shader->fast = job.pass->fast;
        shader->formats = spirv_formats(job.pass);
        shader->own = shaders[BACKEND_VK][index].stage[stage].own;
        if (has_stage(job.pass, stage))
            good &= emit_glsl(model, job.pass, job.backend, stage, shader, job.plan->diag);
    }
    if (list[STAGE_IS_VERTEX].whole.length)
        list[STAGE_IS_FRAGMENT].before = &list[STAGE_IS_VERTEX];
    for (enum stage stage = STAGE_IS_COMPUTE; stage <= STAGE_IS_FRAGMENT; stage++) {
        struct shader *shader = &list[stage];
        if (!has_stage(job.pass, stage) || (job.backend == BACKEND_GL && !shader->own) || !good)
            continue; /* derive() makes OpenGL's */
        shader_hash(job.backend, shader);
        if (!shader_cache_find(cache, shader)) {
            job.shader = shader;
            job.twin = twin_of(first, &job, index);
            good &= add_job(jobs, job);
        }
    }
    return good;
}

/* False when the twin failed to compile, or memory ran out. */
static bool copy_twin(struct shader *shader, const struct shader *twin)
{
    size_t size = twin->word_count * sizeof *twin->words;
    shader->words = size ? malloc(size) : NULL;
    if (!shader->words)
        return false;
    memcpy(shader->words, twin->words, size);
    shader->word_count = twin->word_count;
    return true;
}

/* Compiles a failed shader again, with what its messages teach; reports the last ones. */
static bool compile_again(const struct job *job)
{
    struct shader *shader = job->shader;
    struct model *model = job->plan->model;
    struct diag *diag = job->plan->diag;
    for (;;) {
        char *log = NULL;
        free(shader->words);
        shader->words = NULL;
        bool done = spirv_compile(model, job->pass, job->backend, shader, &log, diag);
        bool again = !done && log && glsl_adapt(model, job->pass, shader, log);
        if (!done && !again && log)
            glsl_report(model, job->pass, shader_code(shader)->data, log, diag);
        free(log);
        if (!again)
            return done;
        text_free(job->backend == BACKEND_VK ? &shader->glsl : &shader->code);
        text_free(&shader->whole);
        if (!emit_glsl(model, job->pass, job->backend, shader->stage, shader, diag))
            return false;
        shader_hash(job->backend, shader);
    }
}

/* Compiles failed shaders again on this thread, so that their messages come in order. */
static bool compile_jobs(struct jobs *jobs, struct cache *cache)
{
    bool good = true;
    compile_rest(jobs);
    CHANGE_EACH(job, jobs->list, jobs->count) {
        if (!good && job->plan != jobs->list[0].plan)
            break; /* it would fail alike */
        bool done =
            job->done || (job->twin && copy_twin(job->shader, job->twin)) || compile_again(job);
        if (done && !job->twin)
            shader_cache_add(cache, job->shader);
        good &= done;
    }
    return good;
}

/* Whether a shader of the pass has the driver filter texels that the others read as codes. */
static bool samples_codes(const struct shader_plan *plan, uint32_t index)
{
    bool samples = false;
    for (int i = 0; i < 6; i++) {
        const struct shader *shader = &plan->shaders[i / 3][index].stage[i % 3];
        struct spirv module = {0};
        samples |= shader->words && spirv_open(&module, shader->words, shader->word_count) &&
                   spirv_samples_codes(&module, plan->model->pipeline.order[index]);
        spirv_free(&module);
    }
    return samples;
}

/* Compiles the shaders of such a pass again, for a view that decodes. */
static bool settle_codes(const struct shader_plan *plan, struct cache *cache)
{
    bool good = true;
    for (uint32_t index = 0; index < plan->model->pipeline.pass_count; index++) {
        struct pass *pass = plan->model->pipeline.order[index];
        if (!pass->codes || !samples_codes(plan, index))
            continue;
        pass->codes = false;
        CHANGE_EACH(access, pass->accesses, pass->access_count)
            access->codes = false;
        for (int i = 0; i < 6; i++) {
            struct job job = {.plan = plan, .pass = pass, .backend = (enum backend)(i / 3)};
            job.shader = &plan->shaders[i / 3][index].stage[i % 3];
            if (!job.shader->words)
                continue;
            free(job.shader->words);
            job.shader->words = NULL;
            job.shader->formats = spirv_formats(pass);
            shader_hash(job.backend, job.shader);
            good = good && (shader_cache_find(cache, job.shader) ||
                            (spirv_init(job.shader->whole.length) && compile_again(&job)));
            if (good)
                shader_cache_add(cache, job.shader);
        }
    }
    return good;
}

/* Loops of CPU drivers; OpenGL's shaders that are not their own. */
static bool derive(const struct shader_plan *plan)
{
    const struct pipeline *pipeline = &plan->model->pipeline;
    char *why = NULL;
    bool good = true;
    for (uint32_t i = 0; good && i < pipeline->pass_count; i++)
        for (int stage = 0; good && stage < 3; stage++) {
            struct shader *vulkan = &plan->shaders[BACKEND_VK][i].stage[stage];
            struct shader *opengl = &plan->shaders[BACKEND_GL][i].stage[stage];
            bool own = opengl->own;
            if (!vulkan->words)
                continue;
            good = (pipeline->gpu ||
                    (spirv_for_cpu(vulkan, &why) && (!own || spirv_for_cpu(opengl, &why)))) &&
                   (own ||
                    (copy_twin(opengl, vulkan) && spirv_make_opengl(pipeline->order[i], opengl)));
        }
    if (!good)
        diag_error(plan->diag, (struct loc){0}, "%s%s",
                   why ? "a shader whose loops are kept apart: spirv-val says: " : "out of memory",
                   why ? why : "");
    free(why);
    return good;
}

bool shaders_are_same(const struct shader *a, const struct shader *b)
{
    return a->word_count == b->word_count &&
           !memcmp(a->words, b->words, a->word_count * sizeof *a->words);
}

/* OpenGL's GLSL text of every shader of all plans. */
static bool write_glsl(const struct shader_plan *plans, uint32_t count, struct jobs *jobs)
{
    bool good = true;
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t k = 0; k < plans[i].model->pipeline.pass_count; k++)
            for (int stage = 0; stage < 3; stage++) {
                struct job job = {.plan = &plans[i], .pass = plans[i].model->pipeline.order[k]};
                job.shader = &plans[i].shaders[BACKEND_GL][k].stage[stage];
                for (uint32_t j = 0; j < jobs->count && !job.twin; j++)
                    if (shaders_are_same(jobs->list[j].shader, job.shader))
                        job.twin = jobs->list[j].shader;
                good &= !job.shader->word_count || add_job(jobs, job);
            }
    compile_rest(jobs);
    CHANGE_EACH(job, jobs->list, jobs->count) {
        if (job->twin)
            text_add_bytes(&job->shader->glsl, job->twin->glsl.data, job->twin->glsl.length);
        else if (!job->done)
            diag_error(job->plan->diag, job->pass->shader_loc,
                       "pass %s has no GLSL text for OpenGL: %s", job->pass->name,
                       job->why ? job->why : "out of memory");
        good &= job->done || job->twin;
        free(job->why);
    }
    return good;
}

/* Whether a resource that the pass writes has the contract `exact`. */
static bool writes_exact(const struct pass *pass)
{
    EACH(access, pass->accesses, pass->access_count)
        if (access->mode != MODE_READ &&
            access->resource->contract.allowed.kind == DT_CONTRACT_EXACT)
            return true;
    return false;
}

static void prove_draws(const struct model *model, const struct pass_shaders *shaders,
                        struct diag *diag)
{
    for (uint32_t i = 0; i < model->pipeline.pass_count; i++)
        if (model->pipeline.order[i]->kind != DT_PASS_DISPATCH && !model->pipeline.order[i]->fast)
            prove_fixed(model->pipeline.order[i], &shaders[i].stage[STAGE_IS_FRAGMENT], diag);
}

/* Also of cached shaders: a pass with another contract may have compiled them. */
static void prove(const struct model *model, const struct pass_shaders *shaders,
                  enum backend backend, struct diag *diag)
{
    for (uint32_t i = 0; i < model->pipeline.pass_count; i++)
        for (int stage = 0; stage < 3; stage++)
            if (shaders[i].stage[stage].word_count && !shaders[i].stage[stage].fast &&
                writes_exact(model->pipeline.order[i]) &&
                (backend == BACKEND_VK || shaders[i].stage[stage].own))
                spirv_prove(model, model->pipeline.order[i], &shaders[i].stage[stage], diag);
}

/* The GLSL of a plan, and jobs. */
static bool emit(const struct shader_plan *plan, const struct shader_plan *first,
                 struct cache *cache, struct jobs *jobs)
{
    uint32_t count = plan->model->pipeline.pass_count;
    bool good = true;
    for (int backend = BACKEND_VK; backend >= BACKEND_GL; backend--) {
        plan->shaders[backend] = calloc(count + 1, sizeof *plan->shaders[backend]);
        if (!plan->shaders[backend])
            return diag_error(plan->diag, (struct loc){0}, "out of memory");
        for (uint32_t i = 0; i < count; i++)
            good &= emit_pass_shaders(first, i, cache,
                                      (struct job){.plan = plan,
                                                   .pass = plan->model->pipeline.order[i],
                                                   .backend = (enum backend)backend},
                                      jobs);
    }
    return good;
}

static bool check(const struct shader_plan *plan)
{
    const struct model *model = plan->model;
    if (model->pipeline.exactness == EXACTNESS_FAST && model->prove)
        diag_error(plan->diag, model->pipeline.loc,
                   "`exactness: fast` leaves operations to the driver: nothing can be proved");
    for (enum backend backend = BACKEND_GL; backend <= BACKEND_VK; backend++)
        prove(model, plan->shaders[backend], backend, plan->diag);
    if (model->prove)
        prove_draws(model, plan->shaders[BACKEND_VK], plan->diag);
    return !diag_error_count(plan->diag);
}

static bool begin_jobs(struct jobs *jobs, const struct shader_plan *plans, uint32_t count)
{
    size_t most = 1;
    for (uint32_t i = 0; i < count; i++)
        most += 4 * (size_t)plans[i].model->pipeline.pass_count;
    *jobs = (struct jobs){.list = calloc(most, sizeof *jobs->list),
                          .lock = PTHREAD_MUTEX_INITIALIZER,
                          .more = PTHREAD_COND_INITIALIZER};
    if (!jobs->list)
        diag_error(plans->diag, (struct loc){0}, "out of memory");
    return jobs->list;
}

bool shaders_compile(const struct shader_plan *plans, uint32_t count, struct cache *cache)
{
    struct jobs jobs, texts;
    if (!begin_jobs(&jobs, plans, count))
        return false;
    bool good = true;
    for (uint32_t i = 0; good && i < count; i++)
        good = emit(&plans[i], i ? plans : NULL, cache, &jobs);
    if (jobs.count)
        good &= compile_jobs(&jobs, cache);
    free(jobs.list);
    for (uint32_t i = 0; good && i < count; i++) {
        good = settle_codes(&plans[i], cache) && derive(&plans[i]);
        if (good)
            check_listed(plans[i].model, plans[i].shaders[BACKEND_VK], plans[i].diag);
    }
    if (good && plans->model->text) {
        good = begin_jobs(&texts, plans, count);
        texts.texts = true;
        good = good && write_glsl(plans, count, &texts);
        free(texts.list);
    }
    for (uint32_t i = 0; good && i < count; i++)
        good = check(&plans[i]);
    return good;
}

void shaders_free(const struct model *model, struct pass_shaders *shaders[2])
{
    for (int backend = 0; backend < 2; backend++) {
        for (uint32_t i = 0; shaders[backend] && i < model->pipeline.pass_count; i++)
            for (int stage = 0; stage < 3; stage++) {
                text_free(&shaders[backend][i].stage[stage].glsl);
                text_free(&shaders[backend][i].stage[stage].code);
                text_free(&shaders[backend][i].stage[stage].whole);
                free(shaders[backend][i].stage[stage].words);
            }
        free(shaders[backend]);
        shaders[backend] = NULL;
    }
}
