/* Compiles a pipeline's shaders ahead; see warm.h. */
#include "view/warm.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* A driver's code may depend on whether a size is a power of two, but not on the size, which is halved
 * until it is no more than SMALL. */
enum { PASSES_AT_ONCE = 4, MOST_CLEARED = 65536, SMALL = 512 };

struct work {
    const struct dt_panel *panel; /* NULL: none */
    struct dt_frame frame;
    void *live;      /* a copy, owned */
    unsigned number; /* of the wish */
};

struct warm {
    const struct dt_runtime *runtime;
    const struct side *side;
    struct dt_scene scene; /* of one triangle */
    pthread_t thread;
    atomic_uint wish;     /* counts what the caller says, to begin and to end */
    pthread_mutex_t lock; /* of what follows */
    pthread_cond_t news;
    struct work next;
    bool taking, stop;
    uint32_t at[2]; /* passes that it is at: the first, and the one behind the last */
    bool met;       /* the caller has come to them */
    /* the thread's own */
    void *handle;
    struct work now;
    bool ready;           /* the device has the scene */
    uint32_t first, last; /* passes of the present frame */
};

/* ---- Frames ---------------------------------------------------------------------------------- */

static const struct dt_pipeline *pipeline_of(const struct warm *warm)
{
    return warm->now.panel->pipeline;
}

/* Its passes have not run, or long ago, in memory that others have written since: what decides how much
 * work a pass has is none. */
static bool clear(struct warm *warm, uint32_t index)
{
    const struct dt_resource *resource = &pipeline_of(warm)->resources[index];
    struct dt_bytes bytes = {0};
    if (resource->kind != DT_BUFFER)
        return true;
    resource->extent(warm->now.frame.width, warm->now.frame.height, bytes.extent);
    bytes.size = (size_t)bytes.extent[0] * resource->stride;
    if (!resource->controls_work && bytes.size > MOST_CLEARED)
        return true;
    bytes.data = calloc(bytes.size ? bytes.size : 1, 1);
    bool good = bytes.data && warm->runtime->write(warm->handle, index, 0, &bytes);
    free(bytes.data);
    return good;
}

static enum dt_action before_pass(void *user, uint32_t index)
{
    struct warm *warm = user;
    const struct dt_pass *pass = &pipeline_of(warm)->passes[index];
    if (atomic_load(&warm->wish) != warm->now.number)
        return DT_STOP;
    if (index < warm->first || index >= warm->last)
        return DT_SKIP;
    for (uint32_t i = 0; i < pass->read_count; i++)
        if (!clear(warm, pass->reads[i]))
            return DT_STOP;
    return DT_RUN;
}

/* False: what is left the caller has been at. */
static bool set_place(struct warm *warm, uint32_t first, uint32_t last)
{
    pthread_mutex_lock(&warm->lock);
    bool met = warm->met;
    warm->met = false;
    warm->at[0] = met ? 0 : first;
    warm->at[1] = met ? 0 : last;
    pthread_cond_broadcast(&warm->news);
    pthread_mutex_unlock(&warm->lock);
    return !met;
}

static void run_passes(struct warm *warm)
{
    const struct dt_observer observer = {.before_pass = before_pass, .user = warm};
    bool good = true;
    for (warm->last = pipeline_of(warm)->pass_count; good && warm->last > 0;
         warm->last = warm->first) {
        warm->first = warm->last > PASSES_AT_ONCE ? warm->last - PASSES_AT_ONCE : 0;
        good = set_place(warm, warm->first, warm->last) &&
               warm->runtime->render(warm->handle, &warm->now.frame, warm->now.live, &observer);
    }
    set_place(warm, 0, 0);
}

/* ---- The thread ------------------------------------------------------------------------------ */

static bool open_device(struct warm *warm)
{
    const struct dt_runtime_options options = {.device = warm->side->device,
                                               .glsl = warm->side->glsl};
    if (!warm->handle)
        warm->handle = warm->runtime->open(&options);
    return warm->handle && warm->runtime->set_scene(warm->handle, &warm->scene);
}

/* The panel before gives the new one the programs that they have in common, and goes. */
static bool take(struct warm *warm)
{
    const struct dt_frame *frame = &warm->now.frame;
    warm->ready = warm->ready || open_device(warm);
    return warm->ready && warm->runtime->create(warm->handle, warm->now.panel) &&
           warm->runtime->resize(warm->handle, frame->width, frame->height);
}

static void *run(void *user)
{
    struct warm *warm = user;
    pthread_mutex_lock(&warm->lock);
    while (!warm->stop) {
        if (!warm->next.panel) {
            pthread_cond_wait(&warm->news, &warm->lock);
            continue;
        }
        warm->now = warm->next;
        warm->next = (struct work){0};
        warm->taking = true;
        pthread_mutex_unlock(&warm->lock);
        bool taken = take(warm);
        pthread_mutex_lock(&warm->lock);
        warm->taking = false;
        pthread_cond_broadcast(&warm->news);
        pthread_mutex_unlock(&warm->lock);
        if (taken)
            run_passes(warm);
        free(warm->now.live);
        pthread_mutex_lock(&warm->lock);
    }
    pthread_mutex_unlock(&warm->lock);
    warm->runtime->close(warm->handle);
    return NULL;
}

/* ---- The caller's ---------------------------------------------------------------------------- */

struct warm *warm_start(const struct dt_runtime *runtime, const struct side *side,
                        const struct dt_scene *scene)
{
    struct warm *warm = calloc(1, sizeof *warm);
    if (!warm)
        return NULL;
    warm->runtime = runtime;
    warm->side = side;
    warm->scene = *scene;
    warm->scene.index_count = scene->index_count < 3 ? scene->index_count : 3;
    pthread_mutex_init(&warm->lock, NULL);
    pthread_cond_init(&warm->news, NULL);
    if (pthread_create(&warm->thread, NULL, run, warm) == 0)
        return warm;
    pthread_cond_destroy(&warm->news);
    pthread_mutex_destroy(&warm->lock);
    free(warm);
    return NULL;
}

static uint32_t smaller(uint32_t size)
{
    while (size > SMALL)
        size /= 2;
    return size;
}

void warm_begin(struct warm *warm, const struct dt_panel *panel, const struct dt_frame *frame,
                const void *live)
{
    uint32_t size = panel->pipeline->live_size;
    struct work work = {.panel = panel, .frame = *frame, .live = malloc(size)};
    if (!work.live)
        return;
    memcpy(work.live, live, size);
    work.frame.width = smaller(frame->width);
    work.frame.height = smaller(frame->height);
    work.frame.triangle_count = warm->scene.index_count / 3;
    work.number = atomic_fetch_add(&warm->wish, 1) + 1;
    pthread_mutex_lock(&warm->lock);
    free(warm->next.live);
    warm->next = work;
    pthread_cond_broadcast(&warm->news);
    pthread_mutex_unlock(&warm->lock);
}

void warm_meet(struct warm *warm, uint32_t pass)
{
    pthread_mutex_lock(&warm->lock);
    while (warm->at[0] <= pass && pass < warm->at[1]) {
        warm->met = true;
        pthread_cond_wait(&warm->news, &warm->lock);
    }
    pthread_mutex_unlock(&warm->lock);
}

void warm_end(struct warm *warm)
{
    atomic_fetch_add(&warm->wish, 1);
}

void warm_settle(struct warm *warm)
{
    pthread_mutex_lock(&warm->lock);
    while (warm->next.panel || warm->taking)
        pthread_cond_wait(&warm->news, &warm->lock);
    pthread_mutex_unlock(&warm->lock);
}

void warm_stop(struct warm *warm)
{
    if (!warm)
        return;
    warm_end(warm);
    pthread_mutex_lock(&warm->lock);
    warm->stop = true;
    pthread_cond_broadcast(&warm->news);
    pthread_mutex_unlock(&warm->lock);
    pthread_join(warm->thread, NULL);
    pthread_cond_destroy(&warm->news);
    pthread_mutex_destroy(&warm->lock);
    free(warm->next.live);
    free(warm);
}
