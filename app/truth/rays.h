/* Ray queries on a scene's triangles, by Embree (version 3 or 4): closest hits with materials, and
 * shadows. */
#pragma once

#include "console/vector.h"
#include "diptych.h"

/* A point on a surface. Its normals are on the side that the ray came from. */
struct ray_hit {
    struct vec3 position;
    struct vec3 geometric; /* unit normal of the triangle */
    struct vec3 normal;    /* unit, interpolated; on the side of `geometric` */
    struct vec3 albedo;    /* 0..1 */
    struct vec3 emission;  /* radiance, W/(m2 sr) */
    /* Upper bound of the position's distance from the triangle: 32 units in the last place of the
     * triangle's largest coordinate. The interpolation errs by about 7 (Pharr et al., "Physically
     * Based Rendering", on managing rounding error), the subtraction of the next ray's origin by a
     * few more. */
    float clearance;
};

struct ray_scene;

/* Borrows the arrays of `scene` until ray_scene_close. The hierarchy is built by one thread, so
 * that it is the same in every run. NULL, with the error logged, when Embree cannot. */
struct ray_scene *ray_scene_open(const struct dt_scene *scene, const struct dt_log *log);
void ray_scene_close(struct ray_scene *rays); /* takes NULL */

/* Closest hit; `direction` is a unit vector. Holes of alpha-tested textures do not count. Textures
 * are read from mip 0, bilinear, repeated. */
bool ray_closest(const struct ray_scene *rays, struct vec3 origin, struct vec3 direction,
                 struct ray_hit *hit);

/* Whether anything lies between origin and origin + farthest * direction; INFINITY is allowed. */
bool ray_blocked(const struct ray_scene *rays, struct vec3 origin, struct vec3 direction,
                 float farthest);

/* Origin of a ray that leaves the hit on the side of `geometric`: moved off the surface by
 * `clearance`, so that the ray does not hit it again. */
struct vec3 ray_origin(const struct ray_hit *hit);
