/* The triangles of a scene as rays see them, by Embree (version 3 or 4): closest hits with the
 * surface's material, and shadows. Called by tracer, from any number of threads. */
#ifndef DIPTYCH_RAYS_H
#define DIPTYCH_RAYS_H

#include "base/vector.h"
#include "diptych.h"

/* A point on a surface, turned to the side that the ray came from, whichever way the triangle is
 * wound and its normals point. */
struct ray_hit {
    struct vec3 position;
    struct vec3 geometric; /* unit normal of the triangle */
    struct vec3 normal;    /* unit, interpolated; on the side of `geometric` */
    struct vec3 albedo;    /* 0..1 */
    struct vec3 emission;  /* radiance, W/(m2 sr) */
    /* How far the position may lie off the triangle, with room to spare: 32 units in the last place
     * of the triangle's largest coordinate. The interpolation errs by about 7 (Pharr et al.,
     * "Physically Based Rendering", on managing rounding error), the subtraction of the next ray's
     * origin by a few more. Scales with the scene. */
    float clearance;
};

struct ray_scene;

/* Borrows the arrays of `scene` until ray_scene_close. The hierarchy is built by one thread, so
 * that it is the same in every run. NULL, with the error logged, when Embree cannot. */
struct ray_scene *ray_scene_open(const struct dt_scene *scene, const struct dt_log *log);
void ray_scene_close(struct ray_scene *rays); /* takes NULL */

/* The first surface that a ray meets; `direction` is a unit vector. Holes of alpha-tested textures
 * are none. Textures are read from mip 0, bilinear, repeated. */
bool ray_closest(const struct ray_scene *rays, struct vec3 origin, struct vec3 direction,
                 struct ray_hit *hit);

/* Whether anything lies between origin and origin + farthest * direction; INFINITY is allowed. */
bool ray_blocked(const struct ray_scene *rays, struct vec3 origin, struct vec3 direction,
                 float farthest);

/* Where a ray starts that leaves the hit on the side of `geometric`: off the surface by `clearance`,
 * so that it does not find the surface that it leaves. */
struct vec3 ray_origin(const struct ray_hit *hit);

#endif
