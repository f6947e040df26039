/* What one pass needs of a device, as its panel says. Included by front.c, which checks it, and by
 * gen/print/needs.c, which prints it. */
#ifndef DIPTYCH_DEVICE_NEEDS_H
#define DIPTYCH_DEVICE_NEEDS_H

#include "panel.h"

/* Of a pass's bindings. Shaders of a draw share them. */
static inline uint64_t dt_bound(const struct dt_program *program, unsigned kinds)
{
    uint64_t count = 0;
    for (uint32_t i = 0; i < program->binding_count; i++)
        count += kinds >> program->bindings[i].kind & 1;
    return count;
}

/* Bytes of the built-in uniform blocks; those of buffers depend on the frame. */
static inline uint64_t dt_block_bytes(const struct dt_panel *panel, uint32_t pass)
{
    const struct dt_program *program = &panel->programs[pass];
    uint64_t most = 0;
    for (uint32_t i = 0; i < program->binding_count; i++) {
        const struct dt_binding *binding = &program->bindings[i];
        uint64_t bytes = binding->kind != DT_BIND_UNIFORM ? 0
                         : binding->resource == DT_SCENE_MATERIALS
                             ? DT_MAX_MATERIALS * sizeof(struct dt_material)
                         : binding->resource == DT_LIVE  ? panel->pipeline->block_size
                         : binding->resource == DT_FRAME ? sizeof(struct dt_frame)
                                                         : 0;
        most = bytes > most ? bytes : most;
    }
    return most;
}

/* The demand that the panel lists; 0: none. */
static inline uint64_t dt_listed(const struct dt_panel *panel, uint32_t pass,
                                 enum dt_device_limit limit)
{
    for (uint32_t i = 0; i < panel->demand_count; i++)
        if (panel->demands[i].pass == pass && panel->demands[i].limit == limit)
            return panel->demands[i].amount;
    return 0;
}

/* What the pass needs of the limit, whatever the size of the frame; 0: nothing. */
static inline uint64_t dt_demand_of(const struct dt_panel *panel, uint32_t pass,
                                    enum dt_device_limit limit)
{
    enum {
        UNIFORM = 1 << DT_BIND_UNIFORM,
        STORAGE = 1 << DT_BIND_STORAGE,
        TEXELS = 1 << DT_BIND_TEXELS,
        TEXTURE = 1 << DT_BIND_TEXTURE,
        IMAGE = 1 << DT_BIND_IMAGE
    };
    const struct dt_program *program = &panel->programs[pass];
    bool draws = panel->pipeline->passes[pass].kind != DT_PASS_DISPATCH;
    switch (limit) {
    case DT_LIMIT_UNIFORMS:
        return dt_bound(program, UNIFORM);
    case DT_LIMIT_STORAGES:
        return dt_bound(program, STORAGE);
    case DT_LIMIT_TEXTURES:
        return dt_bound(program, TEXELS | TEXTURE);
    case DT_LIMIT_SAMPLERS:
        return dt_bound(program, TEXTURE);
    case DT_LIMIT_IMAGES:
        return dt_bound(program, IMAGE);
    case DT_LIMIT_RESOURCES:
        return program->binding_count + program->color_count;
    case DT_LIMIT_COLOR_TARGETS:
        return program->color_count;
    case DT_LIMIT_ATTRIBUTES:
        return (uint64_t)__builtin_popcount(program->attributes);
    case DT_LIMIT_CLIP_DISTANCES:
        return program->clip_distances;
    case DT_LIMIT_PUSH_BYTES:
        return draws && program->layered ? sizeof(int32_t) : 0;
    case DT_LIMIT_UNIFORM_BYTES:
        return dt_block_bytes(panel, pass);
    default:
        return dt_listed(panel, pass, limit);
    }
}

#endif
