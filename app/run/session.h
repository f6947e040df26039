/* One backend with one pipeline and one scene: open, upload, create, resize, frames, close. */
#pragma once

#include "console/console.h"
#include "console/setup.h"
#include "spec/pipeline.h"
#include "run/side.h"
#include "scenes/scene.h"

struct session_info {
    const struct side *side; /* a live one */
    struct console *console;
    const struct setup *setup;
    const struct pipeline *pipeline;
    const struct scene *scene;
    bool timing, keep_history;          /* see struct dt_runtime_options */
    int poison;                         /* see struct dt_runtime_options */
    bool name_in_log;                   /* put the side's label before its messages */
    uint32_t first_frame;               /* index of the first frame, usually 0 */
    const struct dt_frame *frame_block; /* NULL: as the scene and the frame's number make it */
};

struct session {
    struct session_info info;
    const struct dt_runtime *runtime;
    void *handle;
    struct log_source source;
    struct dt_log log;
    uint32_t frame; /* index of the next one */
    bool for_gpu;   /* session_create has taken the plan for GPUs of `target: auto` */
};

/* session_open creates the context or device; session_prepare uploads and creates everything up to
 * the first frame. On false the error is logged; close it in any case. */
bool session_open(struct session *session, const struct session_info *info);
bool session_prepare(struct session *session);
/* Creates the programs of a pipeline, which lives until the next call: with `target: auto` those for the
 * device, and for the length of the scene against its texel buffers. */
bool session_create(struct session *session, const struct pipeline *pipeline);
/* Resizes the runtime and hands it the inputs of the pipeline. */
bool session_resize(const struct session *session, const uint32_t size[2]);

/* Runs the next frame. The observer may be NULL. */
bool session_frame(struct session *session, const struct dt_observer *observer);

/* False, with an error, when the runtime has seen messages from a validation layer or KHR_debug. */
bool session_is_silent(const struct session *session);
void session_close(struct session *session); /* takes a zeroed one */

/* The scene of --scene, looked up with --scenes or DIPTYCH_SCENES, with the motion of --motion.
 * Without --scene that of scene_none, if no pass of the pipeline uses the scene; NULL: the verb
 * requires --scene. */
bool session_load_scene(struct scene *scene, struct console *console,
                        const struct dt_pipeline *pipeline, const struct setup *setup);
/* Whether no pass uses the scene; else an error names one, and --scene. */
bool session_can_lack_scene(const struct dt_pipeline *pipeline, struct console *console);
/* Number of frames: --frames, else all of the motion, else 1. */
uint32_t session_frames(const struct setup *setup, const struct scene *scene);
