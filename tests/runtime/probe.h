/* A pipeline written by hand, as the generator would write it, with a pass of every kind; its
 * scene; and the expected content of every resource after a frame, which follows from the geometry.
 * For tests of the runtimes. The shaders are tests/runtime/runtime_shaders, compiled to headers of
 * words. */
#pragma once

#include "panel.h"

enum {
    PROBE_COLOR,
    PROBE_DEPTH,
    PROBE_STACK,
    PROBE_STACK_DEPTH,
    PROBE_LEVELS,
    PROBE_MASK, /* shares memory with depth */
    PROBE_DISPLAY,
    PROBE_GLOW,
    PROBE_CLEARED,
    PROBE_SPARE, /* no pass uses it */
    PROBE_ROWS,
    PROBE_FRAMES, /* keeps history */
    PROBE_DRAWS,
    PROBE_KEPT,
    PROBE_GROUPS,
    PROBE_RESOURCES
};

enum {
    PROBE_PLAN,
    PROBE_KEEP,
    PROBE_SCENE,
    PROBE_LAYERS,
    PROBE_AGAIN,
    PROBE_OWN,
    PROBE_COUNT,
    PROBE_LEVEL_0,
    PROBE_LEVEL_1,
    PROBE_LEVEL_2,
    PROBE_MASK_PASS,
    PROBE_SHOW,
    PROBE_GLOW_PASS,
    PROBE_SKIP, /* never runs */
    PROBE_PASSES
};

enum { PROBE_LAYER_COUNT = 4, PROBE_STACK_WIDTH = 16, PROBE_STACK_HEIGHT = 8, PROBE_MIPS = 3 };

struct probe_live {
    uint32_t mask; /* 0: the mask pass clears */
    float scale;
    uint32_t glow;
    uint32_t padding;
};

extern const struct dt_pipeline probe_pipeline;
extern const struct dt_panel probe_panel;
extern const struct dt_stages probe_gl_stages[PROBE_PASSES], probe_vk_stages[PROBE_PASSES];
extern const struct dt_shaders probe_gl, probe_vk;
extern const struct dt_scene probe_scene;

/* For OpenGL's option glsl: the GLSL text of the shaders, from their files. Lives as long as the
 * program. */
const struct dt_shaders *probe_glsl(void);

struct dt_frame probe_frame(uint32_t index);
struct dt_bytes probe_read(const struct dt_runtime *runtime, void *rt, uint32_t resource,
                           uint32_t mip);

/* Each fails the test if a resource has other content. */
void probe_check_color(const struct dt_runtime *runtime, void *rt, uint32_t width, uint32_t height);
void probe_check_depth(const struct dt_runtime *runtime, void *rt, uint32_t width, uint32_t height);
void probe_check_stack(const struct dt_runtime *runtime, void *rt);
/* `frames`: the first element of the buffer of that name. */
void probe_check_rest(const struct dt_runtime *runtime, void *rt, uint32_t width, uint32_t height,
                      uint32_t frames, const struct probe_live *live);

/* Frames of three sizes, passes on and off, with all checks; opens and closes. `options` has a log that
 * counts errors in `errors`, debug, timing and poison 0xab. */
void probe_run(const struct dt_runtime *runtime, const struct dt_runtime_options *options,
               const struct dt_shaders *shaders, const uint32_t *errors);

/* Errors that a runtime has logged since a test set their number to 0. */
extern struct probe_heard {
    uint32_t errors;
    char last[1024];
} probe_heard;
void probe_hear(void *user, enum dt_level level, const char *message);
