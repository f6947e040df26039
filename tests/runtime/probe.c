/* The tables of the pipeline in probe.h, its record, its shaders and its scene. */
#include "probe.h"

#include <stdio.h>
#include <stdlib.h>

#include "shaders.h"

/* ---- Reflection ------------------------------------------------------------------------------ */

static const struct probe_live live_defaults = {.mask = 1, .scale = 0.5f, .glow = 1};

static const struct dt_resource resources[PROBE_RESOURCES] = {
    [PROBE_COLOR] = {.name = "color", .kind = DT_IMAGE, .format = DT_FORMAT_RGBA32F, .mips = 1},
    [PROBE_DEPTH] = {.name = "depth", .kind = DT_IMAGE, .format = DT_FORMAT_D32F, .mips = 1},
    [PROBE_STACK] =
        {.name = "stack", .kind = DT_IMAGE, .format = DT_FORMAT_R32UI, .mips = 1, .layered = true},
    [PROBE_STACK_DEPTH] = {.name = "stack_depth",
                           .kind = DT_IMAGE,
                           .format = DT_FORMAT_D32F,
                           .mips = 1,
                           .layered = true},
    [PROBE_LEVELS] = {.name = "levels",
                      .kind = DT_IMAGE,
                      .format = DT_FORMAT_R32F,
                      .mips = PROBE_MIPS},
    [PROBE_MASK] = {.name = "mask", .kind = DT_IMAGE, .format = DT_FORMAT_R32F, .mips = 1},
    [PROBE_DISPLAY] = {.name = "display", .kind = DT_IMAGE, .format = DT_FORMAT_RGBA8, .mips = 1},
    [PROBE_GLOW] = {.name = "glow", .kind = DT_IMAGE, .format = DT_FORMAT_RGBA8_SRGB, .mips = 1},
    [PROBE_CLEARED] = {.name = "cleared",
                       .kind = DT_IMAGE,
                       .format = DT_FORMAT_RGBA16F,
                       .mips = 2,
                       .layered = true},
    [PROBE_SPARE] = {.name = "spare",
                     .kind = DT_IMAGE,
                     .format = DT_FORMAT_RG16F,
                     .mips = PROBE_MIPS,
                     .layered = true},
    [PROBE_ROWS] = {.name = "rows", .kind = DT_BUFFER, .stride = 4},
    [PROBE_FRAMES] = {.name = "frames", .kind = DT_BUFFER, .stride = 4, .history = true},
    [PROBE_DRAWS] = {.name = "draws", .kind = DT_BUFFER, .stride = 4},
    [PROBE_KEPT] = {.name = "kept", .kind = DT_BUFFER, .stride = 4},
    [PROBE_GROUPS] = {.name = "groups", .kind = DT_BUFFER, .stride = 4},
};

static const struct dt_pass passes[PROBE_PASSES] = {
    [PROBE_PLAN] = {.name = "plan", .kind = DT_PASS_DISPATCH},
    [PROBE_KEEP] = {.name = "keep", .kind = DT_PASS_DISPATCH, .uses_scene = true},
    [PROBE_SCENE] = {.name = "scene", .kind = DT_PASS_DRAW_SCENE, .uses_scene = true},
    [PROBE_LAYERS] = {.name = "layers", .kind = DT_PASS_DRAW_SCENE, .uses_scene = true},
    [PROBE_AGAIN] = {.name = "again", .kind = DT_PASS_DRAW_SCENE, .uses_scene = true},
    [PROBE_OWN] = {.name = "own", .kind = DT_PASS_DRAW_SCENE, .uses_scene = true},
    [PROBE_COUNT] = {.name = "count", .kind = DT_PASS_DISPATCH},
    [PROBE_LEVEL_0] = {.name = "level_0", .kind = DT_PASS_DISPATCH},
    [PROBE_LEVEL_1] = {.name = "level_1", .kind = DT_PASS_DISPATCH},
    [PROBE_LEVEL_2] = {.name = "level_2", .kind = DT_PASS_DRAW_FULLSCREEN},
    [PROBE_MASK_PASS] = {.name = "mask", .kind = DT_PASS_DISPATCH},
    [PROBE_SHOW] = {.name = "show", .kind = DT_PASS_DRAW_FULLSCREEN},
    [PROBE_GLOW_PASS] = {.name = "glow", .kind = DT_PASS_DRAW_FULLSCREEN},
    [PROBE_SKIP] = {.name = "skip", .kind = DT_PASS_DISPATCH},
};

static void extent(const struct dt_pipeline *pipeline, uint32_t resource, uint32_t width,
                   uint32_t height, uint32_t size[3])
{
    static const uint8_t fixed[PROBE_RESOURCES][3] = {
        [PROBE_STACK] = {PROBE_STACK_WIDTH, PROBE_STACK_HEIGHT, PROBE_LAYER_COUNT},
        [PROBE_STACK_DEPTH] = {PROBE_STACK_WIDTH, PROBE_STACK_HEIGHT, PROBE_LAYER_COUNT},
        [PROBE_LEVELS] = {16, 8, 1},
        [PROBE_CLEARED] = {5, 4, 2},
        [PROBE_SPARE] = {13, 7, 2},
        [PROBE_FRAMES] = {8, 1, 1},
        [PROBE_DRAWS] = {10, 1, 1},
        [PROBE_KEPT] = {6, 1, 1},
        [PROBE_GROUPS] = {3, 1, 1},
    };
    const uint8_t *own = fixed[resource];
    (void)pipeline;
    if (own[0])
        dt_set_extent(size, own[0], own[1], own[2]);
    else if (resource == PROBE_ROWS)
        dt_set_extent(size, height, 1, 1);
    else
        dt_set_extent(size, width, height, 1);
}

static uint64_t runs(const struct dt_pipeline *pipeline, uint32_t pass, uint32_t width,
                     uint32_t height, const void *live)
{
    (void)pipeline, (void)pass, (void)width, (void)height, (void)live;
    return 1;
}

const struct dt_pipeline probe_pipeline = {
    .name = "probe",
    .resources = resources,
    .resource_count = PROBE_RESOURCES,
    .passes = passes,
    .pass_count = PROBE_PASSES,
    .live_defaults = &live_defaults,
    .live_size = sizeof live_defaults,
    .block_size = sizeof live_defaults,
    .linear_output = PROBE_COLOR,
    .display_output = PROBE_DISPLAY,
    .extent = extent,
    .runs = runs,
};

/* ---- How it is stored, bound and drawn ------------------------------------------------------- */

static const struct dt_storage storage[PROBE_RESOURCES] = {
    [PROBE_COLOR] = {.usage = DT_WRITE_COLOR | DT_READ_STORAGE | DT_READ_TEXTURE,
                     .slot = 0,
                     .share = -1},
    [PROBE_DEPTH] = {.usage = DT_READ_DEPTH | DT_WRITE_DEPTH | DT_READ_TEXTURE,
                     .slot = 1,
                     .share = -1,
                     .clear = {1, 1, 1, 1}},
    [PROBE_STACK] = {.usage = DT_READ_COLOR | DT_WRITE_COLOR,
                     .slot = 2,
                     .share = -1,
                     .clear = {5, 5, 5, 5}},
    [PROBE_STACK_DEPTH] = {.usage = DT_READ_DEPTH | DT_WRITE_DEPTH,
                           .slot = 3,
                           .share = -1,
                           .clear = {1, 1, 1, 1}},
    [PROBE_LEVELS] = {.usage = DT_WRITE_STORAGE | DT_READ_TEXTURE | DT_WRITE_COLOR,
                      .slot = 4,
                      .share = -1},
    [PROBE_MASK] = {.usage = DT_WRITE_STORAGE | DT_WRITE_CLEAR,
                    .slot = 1,
                    .share = -1,
                    .clear = {7, 7, 7, 7}},
    [PROBE_DISPLAY] = {.usage = DT_WRITE_COLOR, .slot = 5, .share = -1},
    [PROBE_GLOW] = {.usage = DT_READ_COLOR | DT_WRITE_COLOR,
                    .slot = 6,
                    .share = -1,
                    .clear = {0, 0, 0, 0.25f}},
    [PROBE_CLEARED] = {.usage = DT_WRITE_STORAGE | DT_WRITE_CLEAR,
                       .slot = 7,
                       .share = -1,
                       .clear = {1, 2, 3, 4}},
    [PROBE_SPARE] = {.usage = DT_READ_TEXTURE, .slot = 8, .share = -1},
    [PROBE_ROWS] = {.usage = DT_WRITE_STORAGE, .slot = 9, .share = -1},
    [PROBE_FRAMES] = {.usage = DT_READ_STORAGE | DT_WRITE_STORAGE, .slot = 10, .share = -1},
    [PROBE_DRAWS] = {.usage = DT_WRITE_STORAGE | DT_READ_INDIRECT, .slot = 11, .share = -1},
    [PROBE_KEPT] = {.usage = DT_WRITE_STORAGE | DT_READ_INDEX, .slot = 12, .share = -1},
    [PROBE_GROUPS] = {.usage = DT_WRITE_STORAGE | DT_READ_INDIRECT | DT_WRITE_CLEAR,
                      .slot = 13,
                      .share = -1},
};

static const struct dt_sampler samplers[] = {
    {.name = "linear", .linear = true, .wrap = DT_WRAP_CLAMP, .anisotropy = 1},
};

#define BINDINGS(...)                                                                              \
    .bindings = (const struct dt_binding[]){__VA_ARGS__},                                          \
    .binding_count = sizeof((const struct dt_binding[]){__VA_ARGS__}) / sizeof(struct dt_binding)
#define TARGET(what, level, keep)                                                                  \
    &(const struct dt_target)                                                                      \
    {                                                                                              \
        .resource = (what), .mip = (level), .load = (keep)                                         \
    }
#define UNIFORM(number, what)                                                                      \
    {                                                                                              \
        .binding = (number), .resource = (what), .kind = DT_BIND_UNIFORM                           \
    }
#define STORAGE(number, what)                                                                      \
    {                                                                                              \
        .binding = (number), .resource = (what), .kind = DT_BIND_STORAGE                           \
    }
#define IMAGE(number, what, level, how)                                                            \
    {                                                                                              \
        .binding = (number), .resource = (what), .kind = DT_BIND_IMAGE, .mip = (level),            \
        .layout = DT_LAYOUT_GENERAL, .access = (how)                                               \
    }
#define TEXTURE(number, what, level, how, which)                                                   \
    {                                                                                              \
        .binding = (number), .resource = (what), .kind = DT_BIND_TEXTURE, .mip = (level),          \
        .layout = (how), .sampler = (which)                                                        \
    }

static const struct dt_blend add = {0};

static const struct dt_program programs[PROBE_PASSES] = {
    [PROBE_PLAN] = {BINDINGS(UNIFORM(0, DT_FRAME), STORAGE(1, PROBE_DRAWS),
                             STORAGE(2, PROBE_GROUPS))},
    [PROBE_KEEP] = {BINDINGS(STORAGE(0, DT_SCENE_INDICES), STORAGE(1, PROBE_KEPT))},
    [PROBE_SCENE] = {BINDINGS(STORAGE(0, DT_SCENE_MATERIALS),
                              TEXTURE(1, DT_SCENE_TEXTURES, DT_ALL_MIPS, DT_LAYOUT_READ, -1)),
                     .colors = TARGET(PROBE_COLOR, 0, false), .color_count = 1,
                     .depth = TARGET(PROBE_DEPTH, 0, false), .depth_test = true,
                     .depth_write = true, .compare = DT_COMPARE_LESS, .cull = DT_CULL_BACK,
                     .attributes = 0xd},
    [PROBE_LAYERS] = {.colors = TARGET(PROBE_STACK, 0, false),
                      .color_count = 1,
                      .depth = TARGET(PROBE_STACK_DEPTH, 0, false),
                      .depth_test = true,
                      .depth_write = true,
                      .compare = DT_COMPARE_LESS,
                      .layered = true,
                      .attributes = 0x1},
    [PROBE_AGAIN] = {.colors = TARGET(PROBE_STACK, 0, true),
                     .color_count = 1,
                     .depth = TARGET(PROBE_STACK_DEPTH, 0, true),
                     .depth_test = true,
                     .compare = DT_COMPARE_LESS_EQUAL,
                     .layered = true,
                     .attributes = 0x1},
    [PROBE_OWN] = {.colors = TARGET(PROBE_STACK, 0, true),
                   .color_count = 1,
                   .depth = TARGET(PROBE_STACK_DEPTH, 0, true),
                   .depth_test = true,
                   .compare = DT_COMPARE_ALWAYS,
                   .cull = DT_CULL_FRONT,
                   .layered = true,
                   .attributes = 0x1},
    [PROBE_COUNT] = {BINDINGS(UNIFORM(0, DT_FRAME), IMAGE(1, PROBE_COLOR, 0, DT_READ_STORAGE),
                              STORAGE(2, PROBE_ROWS), STORAGE(3, PROBE_FRAMES))},
    [PROBE_LEVEL_0] = {BINDINGS(TEXTURE(0, PROBE_DEPTH, DT_ALL_MIPS, DT_LAYOUT_READ, -1),
                                IMAGE(1, PROBE_LEVELS, 0, DT_WRITE_STORAGE))},
    [PROBE_LEVEL_1] = {BINDINGS(TEXTURE(0, PROBE_LEVELS, 0, DT_LAYOUT_GENERAL, 0),
                                IMAGE(1, PROBE_LEVELS, 1, DT_WRITE_STORAGE))},
    [PROBE_LEVEL_2] = {BINDINGS(TEXTURE(0, PROBE_LEVELS, 1, DT_LAYOUT_GENERAL, -1)),
                       .colors = TARGET(PROBE_LEVELS, 2, false), .color_count = 1},
    [PROBE_MASK_PASS] = {BINDINGS(UNIFORM(0, DT_LIVE), IMAGE(1, PROBE_MASK, 0, DT_WRITE_STORAGE))},
    [PROBE_SHOW] = {BINDINGS(TEXTURE(0, PROBE_COLOR, DT_ALL_MIPS, DT_LAYOUT_READ, -1)),
                    .colors = TARGET(PROBE_DISPLAY, 0, false), .color_count = 1},
    [PROBE_GLOW_PASS] = {.colors = &(const struct dt_target){.resource = PROBE_GLOW, .blend = &add},
                         .color_count = 1},
    [PROBE_SKIP] = {BINDINGS(UNIFORM(0, DT_LIVE), IMAGE(1, PROBE_MASK, 0, DT_WRITE_STORAGE))},
};

static const struct dt_need needs[] = {
    {PROBE_LAYERS, "shaderOutputLayer"},
    {PROBE_AGAIN, "multiDrawIndirect"},
    {PROBE_AGAIN, "drawIndirectFirstInstance"},
};

/* ---- One frame ------------------------------------------------------------------------------- */

/* What a pass waits for. */
static const struct wait {
    struct dt_barrier barriers[3];
    uint32_t count;
} waits[PROBE_PASSES] = {
    [PROBE_SCENE] = {{{PROBE_COLOR, DT_STAGE_COLOR, 0, DT_STAGE_COLOR, DT_WRITE_COLOR,
                       DT_LAYOUT_COLOR, DT_DISCARD},
                      {PROBE_DEPTH, DT_STAGE_DEPTH, 0, DT_STAGE_DEPTH,
                       DT_READ_DEPTH | DT_WRITE_DEPTH, DT_LAYOUT_DEPTH, DT_DISCARD}},
                     2},
    [PROBE_LAYERS] = {{{PROBE_STACK, DT_STAGE_COLOR, 0, DT_STAGE_COLOR, DT_WRITE_COLOR,
                        DT_LAYOUT_COLOR, DT_DISCARD},
                       {PROBE_STACK_DEPTH, DT_STAGE_DEPTH, 0, DT_STAGE_DEPTH,
                        DT_READ_DEPTH | DT_WRITE_DEPTH, DT_LAYOUT_DEPTH, DT_DISCARD}},
                      2},
    [PROBE_AGAIN] = {{{PROBE_DRAWS, DT_STAGE_COMPUTE, DT_WRITE_STORAGE, DT_STAGE_INDIRECT,
                       DT_READ_INDIRECT, DT_LAYOUT_NONE, DT_KEEP},
                      {PROBE_STACK, DT_STAGE_COLOR, DT_WRITE_COLOR, DT_STAGE_COLOR,
                       DT_READ_COLOR | DT_WRITE_COLOR, DT_LAYOUT_COLOR, DT_KEEP},
                      {PROBE_STACK_DEPTH, DT_STAGE_DEPTH, DT_WRITE_DEPTH, DT_STAGE_DEPTH,
                       DT_READ_DEPTH | DT_WRITE_DEPTH, DT_LAYOUT_DEPTH, DT_KEEP}},
                     3},
    [PROBE_OWN] = {{{PROBE_KEPT, DT_STAGE_COMPUTE, DT_WRITE_STORAGE, DT_STAGE_INDEX, DT_READ_INDEX,
                     DT_LAYOUT_NONE, DT_KEEP},
                    {PROBE_STACK, DT_STAGE_COLOR, DT_WRITE_COLOR, DT_STAGE_COLOR,
                     DT_READ_COLOR | DT_WRITE_COLOR, DT_LAYOUT_COLOR, DT_KEEP},
                    {PROBE_STACK_DEPTH, DT_STAGE_DEPTH, DT_WRITE_DEPTH, DT_STAGE_DEPTH,
                     DT_READ_DEPTH | DT_WRITE_DEPTH, DT_LAYOUT_DEPTH, DT_KEEP}},
                   3},
    [PROBE_COUNT] = {{{PROBE_COLOR, DT_STAGE_COLOR, DT_WRITE_COLOR, DT_STAGE_COMPUTE,
                       DT_READ_STORAGE, DT_LAYOUT_GENERAL, DT_KEEP}},
                     1},
    [PROBE_LEVEL_0] = {{{PROBE_DEPTH, DT_STAGE_DEPTH, DT_WRITE_DEPTH, DT_STAGE_COMPUTE,
                         DT_READ_TEXTURE, DT_LAYOUT_READ, DT_KEEP},
                        {PROBE_LEVELS, DT_STAGE_COMPUTE, 0, DT_STAGE_COMPUTE, DT_WRITE_STORAGE,
                         DT_LAYOUT_GENERAL, DT_DISCARD}},
                       2},
    [PROBE_LEVEL_1] = {{{PROBE_LEVELS, DT_STAGE_COMPUTE, DT_WRITE_STORAGE, DT_STAGE_COMPUTE,
                         DT_READ_TEXTURE | DT_WRITE_STORAGE, DT_LAYOUT_GENERAL, DT_KEEP}},
                       1},
    [PROBE_LEVEL_2] = {{{PROBE_LEVELS, DT_STAGE_COMPUTE, DT_WRITE_STORAGE,
                         DT_STAGE_FRAGMENT | DT_STAGE_COLOR, DT_READ_TEXTURE | DT_WRITE_COLOR,
                         DT_LAYOUT_GENERAL, DT_KEEP}},
                       1},
    [PROBE_MASK_PASS] = {{{PROBE_MASK, DT_STAGE_COMPUTE | DT_STAGE_DEPTH, 0,
                           DT_STAGE_COMPUTE | DT_STAGE_CLEAR, DT_WRITE_STORAGE | DT_WRITE_CLEAR,
                           DT_LAYOUT_GENERAL, DT_DISCARD},
                          {PROBE_GROUPS, DT_STAGE_COMPUTE, DT_WRITE_STORAGE,
                           DT_STAGE_INDIRECT | DT_STAGE_CLEAR, DT_READ_INDIRECT | DT_WRITE_CLEAR,
                           DT_LAYOUT_NONE, DT_KEEP}},
                         2},
    [PROBE_SHOW] = {{{PROBE_COLOR, DT_STAGE_COMPUTE, 0, DT_STAGE_FRAGMENT, DT_READ_TEXTURE,
                      DT_LAYOUT_READ, DT_KEEP},
                     {PROBE_DISPLAY, DT_STAGE_COLOR, 0, DT_STAGE_COLOR, DT_WRITE_COLOR,
                      DT_LAYOUT_COLOR, DT_DISCARD}},
                    2},
    [PROBE_GLOW_PASS] = {{{PROBE_GLOW, DT_STAGE_COLOR, 0, DT_STAGE_COLOR,
                           DT_READ_COLOR | DT_WRITE_COLOR, DT_LAYOUT_COLOR, DT_DISCARD}},
                         1},
    [PROBE_SKIP] = {{{PROBE_CLEARED, DT_STAGE_CLEAR, 0, DT_STAGE_CLEAR, DT_WRITE_CLEAR,
                      DT_LAYOUT_GENERAL, DT_DISCARD}},
                    1},
};

static bool run(const struct dt_recording *r, uint32_t pass)
{
    const struct dt_verbs *v = r->verbs;
    void *rt = r->runtime;
    switch (pass) {
    case PROBE_SCENE:
        return v->draw_scene(rt, pass, 1);
    case PROBE_LAYERS:
        return v->draw_scene(rt, pass, PROBE_LAYER_COUNT);
    case PROBE_AGAIN:
        return v->draw_indirect(rt, pass, PROBE_LAYER_COUNT, DT_SCENE_INDICES, PROBE_DRAWS);
    case PROBE_OWN:
        return v->draw_indirect(rt, pass, PROBE_LAYER_COUNT, PROBE_KEPT, PROBE_DRAWS);
    case PROBE_COUNT:
        return v->dispatch(rt, pass, dt_groups(r->height, 64), 1, 1);
    case PROBE_LEVEL_0:
        return v->dispatch(rt, pass, 2, 1, 1);
    case PROBE_MASK_PASS:
        return v->dispatch_indirect(rt, pass, PROBE_GROUPS);
    case PROBE_LEVEL_2:
    case PROBE_SHOW:
    case PROBE_GLOW_PASS:
        return v->draw_fullscreen(rt, pass, 1);
    default:
        return v->dispatch(rt, pass, 1, 1, 1);
    }
}

/* What a pass does that does not run. */
static bool clear(const struct dt_recording *r, uint32_t pass)
{
    const struct dt_verbs *v = r->verbs;
    if (pass == PROBE_MASK_PASS)
        return v->clear_image(r->runtime, pass, PROBE_MASK, 0) &&
               v->clear_buffer(r->runtime, pass, PROBE_GROUPS);
    if (pass == PROBE_GLOW_PASS)
        return v->clear_targets(r->runtime, pass, 1);
    return v->clear_image(r->runtime, pass, PROBE_CLEARED, 0) &&
           v->clear_image(r->runtime, pass, PROBE_CLEARED, 1);
}

static bool record(const struct dt_recording *r)
{
    const struct probe_live *live = r->live;
    const struct dt_verbs *v = r->verbs;
    bool good = true;
    for (uint32_t pass = 0; good && pass < PROBE_PASSES; pass++) {
        const struct wait *wait = &waits[pass];
        const bool active = pass == PROBE_MASK_PASS   ? live->mask
                            : pass == PROBE_GLOW_PASS ? live->glow
                                                      : pass != PROBE_SKIP;
        good = v->begin(r->runtime, pass, active) &&
               (!wait->count || v->barriers(r->runtime, pass, wait->barriers, wait->count)) &&
               (active ? v->bind(r->runtime, pass) && run(r, pass) : clear(r, pass)) &&
               v->end(r->runtime, pass);
    }
    return good;
}

const struct dt_panel probe_panel = {
    .version = DT_VERSION,
    .pipeline = &probe_pipeline,
    .storage = storage,
    .programs = programs,
    .samplers = samplers,
    .sampler_count = DT_ARRAY_COUNT(samplers),
    .needs = needs,
    .need_count = DT_ARRAY_COUNT(needs),
    .slot_count = 14,
    .record = record,
};

/* ---- Shaders --------------------------------------------------------------------------------- */

#define CODE(words)                                                                                \
    {                                                                                              \
        words, sizeof(words), NULL                                                                 \
    }
#define STAGES(prefix)                                                                             \
    {                                                                                              \
        [PROBE_PLAN] = {.compute = CODE(prefix##plan_comp)},                                       \
        [PROBE_KEEP] = {.compute = CODE(prefix##keep_comp)},                                       \
        [PROBE_SCENE] = {.vertex = CODE(prefix##scene_vert),                                       \
                         .fragment = CODE(prefix##scene_frag)},                                    \
        [PROBE_LAYERS] = {.vertex = CODE(prefix##layers_vert),                                     \
                          .fragment = CODE(prefix##layers_frag)},                                  \
        [PROBE_AGAIN] = {.vertex = CODE(prefix##layers_vert),                                      \
                         .fragment = CODE(prefix##again_frag)},                                    \
        [PROBE_OWN] = {.vertex = CODE(prefix##layers_vert), .fragment = CODE(prefix##again_frag)}, \
        [PROBE_COUNT] = {.compute = CODE(prefix##count_comp)},                                     \
        [PROBE_LEVEL_0] = {.compute = CODE(prefix##level_0_comp)},                                 \
        [PROBE_LEVEL_1] = {.compute = CODE(prefix##level_1_comp)},                                 \
        [PROBE_LEVEL_2] = {.vertex = CODE(prefix##display_vert),                                   \
                           .fragment = CODE(prefix##level_2_frag)},                                \
        [PROBE_MASK_PASS] = {.compute = CODE(prefix##mask_comp)},                                  \
        [PROBE_SHOW] = {.vertex = CODE(prefix##display_vert),                                      \
                        .fragment = CODE(prefix##display_frag)},                                   \
        [PROBE_GLOW_PASS] = {.vertex = CODE(prefix##display_vert),                                 \
                             .fragment = CODE(prefix##glow_frag)},                                 \
        [PROBE_SKIP] = {.compute = CODE(prefix##mask_comp)},                                       \
    }

const struct dt_stages probe_gl_stages[PROBE_PASSES] = STAGES(gl_);
const struct dt_stages probe_vk_stages[PROBE_PASSES] = STAGES();
const struct dt_shaders probe_gl = {"gl", &probe_panel, probe_gl_stages};
const struct dt_shaders probe_vk = {"vk", &probe_panel, probe_vk_stages};

/* By pass: compute, or vertex and fragment. */
static const char *const files[PROBE_PASSES][2] = {
    [PROBE_PLAN] = {"plan.comp"},
    [PROBE_KEEP] = {"keep.comp"},
    [PROBE_SCENE] = {"scene.vert", "scene.frag"},
    [PROBE_LAYERS] = {"layers.vert", "layers.frag"},
    [PROBE_AGAIN] = {"layers.vert", "again.frag"},
    [PROBE_OWN] = {"layers.vert", "again.frag"},
    [PROBE_COUNT] = {"count.comp"},
    [PROBE_LEVEL_0] = {"level_0.comp"},
    [PROBE_LEVEL_1] = {"level_1.comp"},
    [PROBE_LEVEL_2] = {"display.vert", "level_2.frag"},
    [PROBE_MASK_PASS] = {"mask.comp"},
    [PROBE_SHOW] = {"display.vert", "display.frag"},
    [PROBE_GLOW_PASS] = {"display.vert", "glow.frag"},
    [PROBE_SKIP] = {"mask.comp"},
};

static const char *read_text(const char *name)
{
    char path[64], *text = calloc(1, 8192);
    snprintf(path, sizeof path, "tests/runtime/runtime_shaders/%s", name);
    FILE *file = fopen(path, "r");
    if (!text || !file || !fread(text, 1, 8191, file)) {
        fprintf(stderr, "%s: cannot be read; run the test in the project's folder\n", path);
        exit(1);
    }
    fclose(file);
    return text;
}

const struct dt_shaders *probe_glsl(void)
{
    static struct dt_stages stages[PROBE_PASSES];
    static const struct dt_shaders shaders = {"gl", &probe_panel, stages};
    for (int pass = 0; pass < PROBE_PASSES && !shaders.stages[PROBE_PASSES - 1].compute.glsl;
         pass++) {
        stages[pass] = probe_gl_stages[pass];
        if (files[pass][1]) {
            stages[pass].vertex.glsl = read_text(files[pass][0]);
            stages[pass].fragment.glsl = read_text(files[pass][1]);
        } else {
            stages[pass].compute.glsl = read_text(files[pass][0]);
        }
    }
    return &shaders;
}

/* ---- The scene ------------------------------------------------------------------------------- */

/* Material 0 on the left half at depth 0.5, material 1 in front of it on the rows of y < 0. */
static const struct dt_vertex vertices[] = {
    {.position = {-1, -1, 0.5f}},
    {.position = {0, -1, 0.5f}},
    {.position = {0, 1, 0.5f}},
    {.position = {-1, 1, 0.5f}},
    {.position = {-1, -1, 0.25f}, .uv = {0, 0}, .material = 1},
    {.position = {1, -1, 0.25f}, .uv = {1, 0}, .material = 1},
    {.position = {1, 0, 0.25f}, .uv = {1, 1}, .material = 1},
    {.position = {-1, 0, 0.25f}, .uv = {0, 1}, .material = 1},
    {.position = {-1, -1, 0.125f}},
    {.position = {1, 1, 0.125f}},
    {.position = {1, -1, 0.125f}},
};
static const uint32_t indices[] = {
    0, 1, 2,  0, 2, 3, 4, 5, 6, 4, 6, 7, /* counterclockwise with y up: seen */
    8, 9, 10,                            /* clockwise: culled where the pass says so */
};
static const struct dt_material materials[] = {
    {.albedo = {0.25f, 0.5f, 0.75f}, .texture = -1},
    {.albedo = {0.5f, 0.5f, 0.5f}, .texture = 1},
};
#define WHITE 255, 255, 255, 255
#define RED   255, 0, 0, 255
static const uint8_t texels[] = {WHITE, WHITE, WHITE, WHITE, RED, RED, RED, RED, WHITE, RED};

const struct dt_scene probe_scene = {
    .vertices = vertices,
    .vertex_count = DT_ARRAY_COUNT(vertices),
    .indices = indices,
    .index_count = DT_ARRAY_COUNT(indices),
    .materials = materials,
    .material_count = DT_ARRAY_COUNT(materials),
    .texels = texels,
    .texture_width = 2,
    .texture_height = 2,
    .texture_layers = 2,
    .texture_mips = 2,
};

/* ---- Log ------------------------------------------------------------------------------------- */

struct probe_heard probe_heard;

void probe_hear(void *user, enum dt_level level, const char *message)
{
    (void)user;
    if (level != DT_ERROR)
        return;
    probe_heard.errors++;
    snprintf(probe_heard.last, sizeof probe_heard.last, "%s", message);
    if (getenv("DIPTYCH_TEST_VERBOSE"))
        printf("# %s\n", message);
}
