/* The path tracer that `reference` drives and the tests hold against closed forms: diffuse light
 * transport through a scene, by paths from the camera. At every hit the source itself is asked
 * (next-event estimation), and so is one point per path that the source lights. It knows the scene
 * as the pipelines get it (struct dt_scene, struct dt_frame) and no command line.
 *
 * Surfaces are Lambertian and seen from both sides. Cosines are those with the interpolated normal,
 * as in the shipped pipelines; no light passes from behind the triangle itself. Light comes as the
 * pipelines have it, equal in falloff and in the border of a directional light's map; a spot is a
 * point. Nothing lies outside the scene: rays that leave it bring no light. */
#pragma once

#include "diptych.h"
#include "truth/film.h"
#include "truth/sequence.h"
#include "truth/vpls.h"

#define TRACER_UNLIMITED UINT32_MAX

enum tracer_output {
    TRACER_RADIANCE,  /* towards the eye, W/(m2 sr) */
    TRACER_IRRADIANCE /* at the surface that a pixel sees, before its albedo, W/m2 */
};

struct tracer_info {
    const struct dt_scene *scene; /* borrowed until tracer_close */
    const struct dt_frame *frame; /* copied; width and height are the picture's */
    const struct dt_log *log;     /* borrowed until tracer_close */
    /* Light that has been reflected between `first_bounce` and `last_bounce` times on its way to the
     * surface that a pixel sees; 0 is direct light. TRACER_UNLIMITED ends paths by Russian
     * roulette. */
    uint32_t first_bounce, last_bounce;
    enum tracer_output output;
    const struct vpl_set *vpls; /* borrowed until tracer_close; not empty: in place of paths */
    /* False: rays through pixel centres, where the rasterizer samples. True: spread evenly over the
     * pixel. */
    bool box_filter;
    bool emission; /* count the emission of materials, found by chance; the pipelines have none */
    enum sequence_kind sequence;
    uint32_t seed;
    uint32_t threads; /* 0: as many as there are processors for this process */
};

struct tracer;

/* NULL with the error logged: no Embree, no memory. */
struct tracer *tracer_open(const struct tracer_info *info);
void tracer_close(struct tracer *tracer); /* takes NULL */

/* Adds the next `samples` samples to every pixel. The film's bits depend on the info without
 * `threads`, and on how many samples it holds, not on how many calls or threads it took. */
bool tracer_add(struct tracer *tracer, struct film *film, uint32_t samples);

/* Where the ray through a place of the picture starts, and its unit direction; in pixels from the
 * upper left corner, so that a pixel's centre lies at halves. */
void tracer_camera_ray(const struct dt_frame *frame, double x, double y, float origin[3],
                       float direction[3]);

uint64_t tracer_rays(const struct tracer *tracer); /* traced so far, shadow rays among them */
