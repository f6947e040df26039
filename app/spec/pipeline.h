/* From a spec and its --set overrides to a pipeline in memory, ready for either runtime. */
#pragma once

#include "console/console.h"
#include "console/setup.h"
#include "result/identity.h"
#include "spec/plan.h"

/* A loaded pipeline. All pointers live until pipeline_unload. */
struct pipeline {
    const struct dt_pipeline *info;
    const struct dt_shaders *gl, *vk;
    void *live;             /* info->live_size bytes, initially info->live_defaults; owned */
    struct plan *plan;      /* owned */
    char *spec, *templates; /* real paths of the spec and of the templates folder; owned */
    struct input *inputs;   /* see inputs.h; NULL: not loaded; owned */
    uint32_t input_count;
    struct input_hash *input_hashes; /* of those of --input, see identity.h; owned */
    uint32_t input_hash_count;
    uint32_t frame_size[2]; /* the only one that --input fits; 0: any */
};

/* Reads, checks and plans; compiles the shaders that the cache does not have: in build/cache beside the
 * executable, or in $XDG_CACHE_HOME/diptych when it is installed or that cannot be written. --set of a live
 * parameter only changes its default. On false the error is logged and nothing is left loaded. */
bool pipeline_load(struct pipeline *pipeline, struct console *console, const struct setup *setup);
/* Whether another process, which may crash or hang, takes the spec: it leaves the shaders in the cache, so
 * that pipeline_load has little left to do. Its messages are printed. target: what `target: auto` is for
 * pipeline_load; NULL: the spec has another. */
bool pipeline_try(struct console *console, const struct setup *setup, const char *target);
/* Puts the contracts of a file in place of the spec's; the file's live as long as the pipeline. Logs its error. */
struct contracts;
bool pipeline_contracts(struct pipeline *pipeline, const char *path, struct contracts *contracts,
                        const struct dt_log *log);
/* Of its frame `setup->frames`; backend and device are not set. */
struct identity pipeline_identity(const struct pipeline *pipeline, const struct scene *scene,
                                  const struct setup *setup);
void pipeline_unload(struct pipeline *pipeline); /* takes a zeroed one */

/* A resource or a live parameter by name. The error names `what` asks for it, and a similar name. */
bool pipeline_find(const struct dt_pipeline *info, const char *what, const char *name,
                   uint32_t *resource, const struct dt_log *log);
const struct dt_param *pipeline_find_live(const struct dt_pipeline *info, const char *what,
                                          const char *name, const struct dt_log *log);
