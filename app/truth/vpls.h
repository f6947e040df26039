/* Virtual point lights (VPLs) in place of paths: what a pipeline's VPLs give with exact rays. Called by
 * the tracer; `reference --vpls` reads them. */
#pragma once

#include "diptych.h"
#include "truth/rays.h"

struct vpl {
    float position[3], normal[3]; /* unit normal */
    float flux[3];                /* W */
    float disk;                   /* squared radius, m2; 0: a point */
    /* Rays lead there to tell whether the VPL is visible: the VPL itself, or the eye of its map. */
    float eye[3];
    /* The VPL is visible if its squared distance to the receiver is below this, or below that from what
     * hides the eye to the receiver; 0: only by the ray. */
    float near_square;
};

struct vpl_set {
    struct vpl *vpls; /* free() */
    uint32_t count;
};

/* From a structured array of NumPy with these fields, float32. False: logged. */
bool vpls_read(struct vpl_set *set, const char *path, const struct dt_log *log);

/* Irradiance, W/m2, that the lights bring to the hit. `closest`: least squared distance that counts, m2.
 * Adds the rays to *traced. */
struct vec3 vpls_irradiance(const struct vpl_set *set, const struct ray_scene *rays,
                            const struct ray_hit *hit, float closest, uint64_t *traced);
