/* Virtual point lights by exact rays; see vpls.h. */
#include "truth/vpls.h"

#include "base/log.h"
#include "base/npy.h"

static const float pi = 3.14159265358979f;

bool vpls_read(struct vpl_set *set, const char *path, const struct dt_log *log)
{
    static const struct dt_field fields[] = {
        {.name = "position", .type = DT_TYPE_VEC3}, {.name = "normal", .type = DT_TYPE_VEC3},
        {.name = "flux", .type = DT_TYPE_VEC3},     {.name = "disk", .type = DT_TYPE_FLOAT},
        {.name = "eye", .type = DT_TYPE_VEC3},      {.name = "near_square", .type = DT_TYPE_FLOAT},
    };
    struct npy array;
    const char *reason;
    const float *numbers = npy_read(path, &array, &reason);
    set->vpls = (struct vpl *)numbers;
    if (!numbers)
        return report_error(log, "--vpls %s: %s", path, reason);
    set->count = array.count;
    reason = npy_misfit(&array, fields, DT_ARRAY_COUNT(fields));
    for (size_t i = 0; !reason && i < (size_t)array.count * array.numbers; i++)
        reason = isfinite(numbers[i]) ? NULL : "a number is not finite";
    return !reason || report_error(log, "--vpls %s: %s", path, reason);
}

/* Geometry term of a disk, 1/m2: that of a point, bounded where the receiver is nearer than the radius. */
static float geometry_term(const struct vpl *vpl, struct vec3 d, const struct ray_hit *hit,
                           float closest)
{
    float square = fmaxf(dot(d, d), closest);
    float leaving = fmaxf(dot(vec3_of(vpl->normal), d), 0);
    float arriving = fmaxf(-dot(hit->normal, d), 0);
    return leaving * arriving / (square * square + vpl->disk * leaving * sqrtf(square));
}

/* d: from the VPL to the hit. */
static bool is_visible(const struct vpl *vpl, struct vec3 d, const struct ray_scene *rays,
                       const struct ray_hit *hit, uint64_t *traced)
{
    struct vec3 origin = ray_origin(hit), eye = vec3_of(vpl->eye);
    ++*traced;
    if (!ray_blocked(rays, origin, subtract(eye, origin), 0.9999f))
        return true;
    float square = dot(d, d);
    if (vpl->near_square <= 0 || square < vpl->near_square)
        return square < vpl->near_square;
    struct ray_hit surface;
    ++*traced;
    if (!ray_closest(rays, eye, unit_or(subtract(origin, eye), d), &surface))
        return false;
    struct vec3 behind = subtract(origin, surface.position);
    return square < dot(behind, behind);
}

struct vec3 vpls_irradiance(const struct vpl_set *set, const struct ray_scene *rays,
                            const struct ray_hit *hit, float closest, uint64_t *traced)
{
    struct vec3 sum = {0, 0, 0};
    for (uint32_t k = 0; k < set->count; k++) {
        const struct vpl *vpl = &set->vpls[k];
        struct vec3 d = subtract(hit->position, vec3_of(vpl->position));
        float geometry = geometry_term(vpl, d, hit, closest);
        if (geometry > 0 && is_visible(vpl, d, rays, hit, traced))
            sum = add(sum, scale(vec3_of(vpl->flux), geometry / pi));
    }
    return sum;
}
