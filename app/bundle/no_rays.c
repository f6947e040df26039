/* rays.h without Embree, for the bundle: its library alone has 44 MB. Linked in place of rays.c. */
#include "truth/rays.h"

#include "console/console.h"

struct ray_scene *ray_scene_open(const struct dt_scene *scene, const struct dt_log *log)
{
    (void)scene;
    report_error(log, "the bundle has no path tracer; use an installed diptych");
    return NULL;
}

void ray_scene_close(struct ray_scene *rays)
{
    (void)rays;
}

bool ray_closest(const struct ray_scene *rays, struct vec3 origin, struct vec3 direction,
                 struct ray_hit *hit)
{
    (void)rays, (void)origin, (void)direction, (void)hit;
    return false;
}

bool ray_blocked(const struct ray_scene *rays, struct vec3 origin, struct vec3 direction,
                 float farthest)
{
    (void)rays, (void)origin, (void)direction, (void)farthest;
    return false;
}

struct vec3 ray_origin(const struct ray_hit *hit)
{
    return hit->position;
}
