/* What must be the same on two machines before their results can be compared: the spec and its
 * GLSL, --set, live parameters, the scene, the content of --input, the frame's size and index,
 * diptych's version. What tools make of that (SPIR-V, objects) has no part in it: their versions
 * differ. Written into the manifest of a dump, checked by compare --against. */
#pragma once

#include <cjson/cJSON.h>

#include "console/setup.h"
#include "console/console.h"
#include "scenes/scene.h"

struct input_hash {
    const char *name; /* of the input */
    uint64_t hash;    /* of its content */
};

struct identity {
    const char *backend, *device; /* that made it; told, not checked */
    const struct dt_pipeline *pipeline;
    const void *live;             /* its live parameters */
    const char *spec, *templates; /* real paths: where its files are looked up */
    const char *const *sources;   /* paths of the spec and of all GLSL */
    uint32_t source_count;
    const struct input_hash *inputs; /* one for each --input */
    uint32_t input_count;
    const struct scene *scene;
    const struct setup *setup; /* the scene as --scene names it, --set */
    uint32_t size[2];          /* of the frame */
    uint32_t frame;
};

/* Adds diptych, pipeline, params, sources, set, inputs, backend, device, live, scene, scene_file,
 * scene_data, width, height and frame. False: something cannot be read; logged. */
bool identity_add(cJSON *manifest, const struct identity *identity, const struct dt_log *log);

/* Takes size, frame and live parameters from a manifest: what the options give must be the same,
 * the rest takes the manifest's values, the live ones in the block `live`. `folder` is named in
 * errors. */
bool identity_take_frame(const cJSON *manifest, const char *folder, struct setup *setup,
                         const struct dt_log *log);
bool identity_take_live(const cJSON *manifest, const char *folder, const struct setup *setup,
                        const struct dt_pipeline *pipeline, void *live, const struct dt_log *log);

/* Whether the pipeline and the scene are the manifest's; the error says what differs. Another mesh
 * or other mathematics of the machine's library are but a warning. */
bool identity_check(const cJSON *manifest, const char *folder, const struct identity *identity,
                    const struct dt_log *log);

void hash_scene(uint64_t *hash, const struct dt_scene *scene); /* mesh, materials and textures */
