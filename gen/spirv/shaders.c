/* All shaders of a pipeline: GLSL and SPIR-V for every pass, backend and stage. One thread emits
 * the text, since that changes the model. Meanwhile others compile the shaders that are not in the
 * cache. Most of OpenGL's are made of Vulkan's, which takes no time: their GLSL is for people, and
 * for drivers that take text. */
#include "shader_cache.h"
#include "compile.h"
#include "model/cross.h"
#include "values.h"
#include "watchdog.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MOST_THREADS = 8 };

struct job { /* one shader to compile */
    const struct pass *pass;
    enum backend backend;
    struct shader *shader;
    const struct shader *twin; /* earlier shader with the same text, to copy; or NULL */
    bool done;
};

struct jobs {
    const struct model *model;
    struct job *list;
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
        job->done = spirv_compile(jobs->model, job->pass, job->backend, job->shader, NULL, NULL);
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

static bool add_job(struct jobs *jobs, struct job job, struct diag *diag)
{
    if (!spirv_init()) {
        diag_error(diag, (struct loc){0}, "the GLSL compiler could not be started: out of memory");
        return false;
    }
    pthread_mutex_lock(&jobs->lock);
    jobs->list[jobs->count++] = job;
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

/* Emits the GLSL of the pass `index`; adds jobs for shaders that are not in the cache. */
static bool emit_pass_shaders(struct model *model, struct pass_shaders *shaders[2], uint32_t index,
                              struct shader_cache *cache, struct job job, struct jobs *jobs,
                              struct diag *diag)
{
    struct shader *list = shaders[job.backend][index].stage;
    bool good = true;
    for (enum stage stage = STAGE_IS_COMPUTE; stage <= STAGE_IS_FRAGMENT; stage++) {
        struct shader *shader = &list[stage];
        shader->stage = stage;
        shader->fast = job.pass->fast;
        shader->formats = spirv_formats(job.pass);
        shader->own = shaders[BACKEND_VK][index].stage[stage].own;
        if (has_stage(job.pass, stage))
            good &= emit_glsl(model, job.pass, job.backend, stage, shader, diag);
    }
    if (list[STAGE_IS_VERTEX].whole.length)
        list[STAGE_IS_FRAGMENT].before = &list[STAGE_IS_VERTEX];
    for (enum stage stage = STAGE_IS_COMPUTE; stage <= STAGE_IS_FRAGMENT; stage++) {
        struct shader *shader = &list[stage];
        if (!has_stage(job.pass, stage) || (job.backend == BACKEND_GL && !shader->own) || !good)
            continue; /* derive() makes OpenGL's */
        shader_hash(model, job.backend, shader);
        if (!shader_cache_find(cache, shader)) {
            job.shader = shader;
            job.twin = model->sanitize ? NULL : shader_twin(shaders[job.backend], index, stage);
            good &= add_job(jobs, job, diag);
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
static bool compile_again(struct model *model, const struct job *job, struct diag *diag)
{
    struct shader *shader = job->shader;
    for (;;) {
        char *log = NULL;
        free(shader->words);
        shader->words = NULL;
        bool done = spirv_compile(model, job->pass, job->backend, shader, &log, diag);
        bool again = !done && log && glsl_adapt(model, job->pass, shader, log);
        if (!done && !again && log)
            glsl_report(model, job->pass, log, diag);
        free(log);
        if (!again)
            return done;
        text_free(job->backend == BACKEND_VK ? &shader->glsl : &shader->code);
        text_free(&shader->whole);
        if (!emit_glsl(model, job->pass, job->backend, shader->stage, shader, diag))
            return false;
        shader_hash(model, job->backend, shader);
    }
}

/* Compiles failed shaders again on this thread, so that their messages come in order. */
static bool compile(struct model *model, struct jobs *jobs, struct shader_cache *cache,
                    struct diag *diag)
{
    bool good = true;
    compile_rest(jobs);
    for (uint32_t i = 0; i < jobs->count; i++) {
        struct job *job = &jobs->list[i];
        bool done = job->done || (job->twin && copy_twin(job->shader, job->twin)) ||
                    compile_again(model, job, diag);
        if (done && !job->twin)
            shader_cache_add(cache, job->shader);
        good &= done;
    }
    return good;
}

/* OpenGL's shaders that are not their own. */
static bool derive(const struct model *model, struct pass_shaders *shaders[2])
{
    for (uint32_t i = 0; i < model->pipeline.pass_count; i++)
        for (int stage = 0; stage < 3; stage++) {
            const struct shader *vulkan = &shaders[BACKEND_VK][i].stage[stage];
            struct shader *opengl = &shaders[BACKEND_GL][i].stage[stage];
            if (!vulkan->words || opengl->own)
                continue;
            if (!copy_twin(opengl, vulkan) || !spirv_make_opengl(model->pipeline.order[i], opengl))
                return false;
        }
    return true;
}

/* The text of an earlier shader with the same words; NULL: none. */
static const struct text *same_text(const struct pass_shaders *shaders, uint32_t pass, int stage)
{
    const struct shader *shader = &shaders[pass].stage[stage];
    for (uint32_t i = 0; i < pass; i++) {
        const struct shader *other = &shaders[i].stage[stage];
        if (other->word_count == shader->word_count &&
            !memcmp(other->words, shader->words, shader->word_count * sizeof *shader->words))
            return &other->glsl;
    }
    return NULL;
}

/* OpenGL's GLSL text of every shader. */
static bool write_glsl(const struct model *model, struct pass_shaders *shaders, struct diag *diag)
{
    bool good = true;
    for (uint32_t i = 0; i < model->pipeline.pass_count; i++)
        for (int stage = 0; stage < 3; stage++) {
            struct shader *shader = &shaders[i].stage[stage];
            const struct text *same = shader->word_count ? same_text(shaders, i, stage) : NULL;
            char *why = NULL;
            if (same)
                text_add_bytes(&shader->glsl, same->data, same->length);
            if (!shader->word_count || same ||
                spirv_cross(shader->words, shader->word_count, &shader->glsl, &why))
                continue;
            const struct pass *pass = model->pipeline.order[i];
            diag_error(diag, pass->shader_loc, "pass %s has no GLSL text for OpenGL: %s",
                       pass->name, why ? why : "out of memory");
            free(why);
            good = false;
        }
    return good;
}

/* Whether a resource that the pass writes has the contract `exact`. */
static bool writes_exact(const struct pass *pass)
{
    for (uint32_t i = 0; i < pass->access_count; i++)
        if (pass->accesses[i].mode != MODE_READ &&
            pass->accesses[i].resource->contract.allowed.kind == DT_CONTRACT_EXACT)
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

bool shaders_compile(struct model *model, struct pass_shaders *shaders[2],
                     struct shader_cache *cache, struct diag *diag)
{
    uint32_t count = model->pipeline.pass_count;
    struct jobs jobs = {.model = model,
                        .list = calloc(4 * count + 1, sizeof *jobs.list),
                        .lock = PTHREAD_MUTEX_INITIALIZER,
                        .more = PTHREAD_COND_INITIALIZER};
    bool good = true;
    for (int backend = BACKEND_VK; backend >= BACKEND_GL; backend--) {
        shaders[backend] = calloc(count + 1, sizeof *shaders[backend]);
        if (!shaders[backend] || !jobs.list) {
            diag_error(diag, (struct loc){0}, "out of memory");
            good = false;
        }
        for (uint32_t i = 0; shaders[BACKEND_VK] && shaders[backend] && jobs.list && i < count; i++)
            good &= emit_pass_shaders(
                model, shaders, i, cache,
                (struct job){.pass = model->pipeline.order[i], .backend = (enum backend)backend},
                &jobs, diag);
    }
    if (jobs.count)
        good &= compile(model, &jobs, cache, diag);
    if (good && !derive(model, shaders)) {
        diag_error(diag, (struct loc){0}, "out of memory");
        good = false;
    }
    if (good)
        check_listed(model, shaders[BACKEND_VK], diag);
    if (good && model->text)
        good = write_glsl(model, shaders[BACKEND_GL], diag);
    free(jobs.list);
    if (model->pipeline.exactness == EXACTNESS_FAST && model->prove)
        diag_error(diag, model->pipeline.loc,
                   "`exactness: fast` leaves operations to the driver: nothing can be proved");
    for (enum backend backend = BACKEND_GL; backend <= BACKEND_VK; backend++)
        if (good)
            prove(model, shaders[backend], backend, diag);
    if (good && model->prove)
        prove_draws(model, shaders[BACKEND_VK], diag);
    return good && !diag_error_count(diag);
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
