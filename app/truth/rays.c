/* Rays against a scene; see rays.h. Triangles with alpha-tested textures are a geometry of their
 * own: only their hits look into the texture. */
#include "truth/rays.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include "console/console.h"
#include "scenes/srgb.h"

enum { SOLID, WITH_HOLES, GEOMETRIES };

struct ray_scene {
    RTCDevice device;
    RTCScene scene;
    const struct dt_scene *data;
    uint32_t *indices; /* the solid triangles, then those with holes */
    uint32_t solid_count;
    float linear[256]; /* of an sRGB code */
    const struct dt_log *log;
};

/* ---- Materials ------------------------------------------------------------------------------- */

/* One axis of a bilinear lookup: two neighbouring texels, repeated, and the weight of the second. */
static float neighbours(float coordinate, uint32_t size, uint32_t texel[2])
{
    float place = (coordinate - floorf(coordinate)) * (float)size - 0.5f;
    float whole = floorf(place);
    texel[0] = (uint32_t)((int64_t)whole + size) % size;
    texel[1] = (texel[0] + 1) % size;
    return place - whole;
}

/* Linear colour and alpha of a texture layer at uv, from mip 0; layer -1 is white. */
static void sample_texture(const struct ray_scene *rays, int32_t layer, const float uv[2],
                           float texel[4])
{
    const struct dt_scene *data = rays->data;
    uint32_t width = data->texture_width, height = data->texture_height, x[2], y[2];
    for (int c = 0; c < 4; c++)
        texel[c] = layer < 0 ? 1 : 0;
    if (layer < 0)
        return;
    const uint8_t *codes = data->texels + (size_t)layer * width * height * 4;
    float u = neighbours(uv[0], width, x), v = neighbours(uv[1], height, y);
    for (int k = 0; k < 4; k++) {
        const uint8_t *code = codes + ((size_t)y[k >> 1] * width + x[k & 1]) * 4;
        float weight = (k & 1 ? u : 1 - u) * (k >> 1 ? v : 1 - v);
        for (int c = 0; c < 3; c++)
            texel[c] += weight * rays->linear[code[c]];
        texel[3] += weight * (float)code[3] / 255;
    }
}

/* A point of a triangle by its barycentric coordinates, with what is interpolated there. */
struct surface_place {
    const struct dt_vertex *corner[3];
    float weight[3];
};

static struct surface_place find_surface(const struct ray_scene *rays, unsigned geometry,
                                         unsigned primitive, float u, float v)
{
    uint32_t triangle = geometry == SOLID ? primitive : rays->solid_count + primitive;
    struct surface_place place = {.weight = {1 - u - v, u, v}};
    for (int k = 0; k < 3; k++)
        place.corner[k] = &rays->data->vertices[rays->indices[(size_t)triangle * 3 + k]];
    return place;
}

static void surface_texel(const struct ray_scene *rays, const struct surface_place *place,
                          float texel[4])
{
    const struct dt_material *material = &rays->data->materials[place->corner[0]->material];
    float uv[2] = {0, 0};
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 2; i++)
            uv[i] += place->weight[k] * place->corner[k]->uv[i];
    sample_texture(rays, material->texture, uv, texel);
}

/* Embree's filter: rejects hits in holes of the texture. Rays are single, so each call has one
 * hit. */
static void pass_holes(const struct RTCFilterFunctionNArguments *arguments)
{
    const struct ray_scene *rays = arguments->geometryUserPtr;
    const struct RTCHit *hit = (const struct RTCHit *)arguments->hit;
    struct surface_place place = find_surface(rays, WITH_HOLES, hit->primID, hit->u, hit->v);
    float texel[4];
    surface_texel(rays, &place, texel);
    if (texel[3] < rays->data->materials[place.corner[0]->material].alpha_cutoff)
        arguments->valid[0] = 0;
}

/* ---- Building -------------------------------------------------------------------------------- */

static void embree_error(void *user, enum RTCError code, const char *message)
{
    const struct ray_scene *rays = user;
    if (code == RTC_ERROR_OUT_OF_MEMORY)
        report_error(rays->log, "out of memory for the ray tracing hierarchy of %u triangles",
                     rays->data->index_count / 3);
    else
        report_error(rays->log, "Embree: %s", message);
}

/* Copies the triangles in the order of their geometry. */
static bool sort_triangles(struct ray_scene *rays)
{
    const struct dt_scene *data = rays->data;
    uint32_t out = 0;
    /* Embree reads 16 bytes where it needs 12 */
    rays->indices = malloc(((size_t)data->index_count + 4) * sizeof *rays->indices);
    for (int geometry = 0; rays->indices && geometry < GEOMETRIES; geometry++) {
        for (uint32_t i = 0; i + 2 < data->index_count; i += 3) {
            const struct dt_vertex *vertex = &data->vertices[data->indices[i]];
            bool holes = data->materials[vertex->material].alpha_cutoff > 0;
            if (holes != (geometry == WITH_HOLES))
                continue;
            memcpy(rays->indices + out, data->indices + i, 3 * sizeof *rays->indices);
            out += 3;
        }
        if (geometry == SOLID)
            rays->solid_count = out / 3;
    }
    return rays->indices;
}

static void attach(struct ray_scene *rays, unsigned id, uint32_t first, uint32_t count)
{
    RTCGeometry geometry = rtcNewGeometry(rays->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               rays->data->vertices, 0, sizeof *rays->data->vertices,
                               rays->data->vertex_count);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               rays->indices + (size_t)first * 3, 0, 3 * sizeof *rays->indices,
                               count);
    if (id == WITH_HOLES) {
        rtcSetGeometryUserData(geometry, rays);
        rtcSetGeometryIntersectFilterFunction(geometry, pass_holes);
        rtcSetGeometryOccludedFilterFunction(geometry, pass_holes);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(rays->scene, geometry, id);
    rtcReleaseGeometry(geometry);
}

static bool build_scene(struct ray_scene *rays)
{
    uint32_t count = rays->data->index_count / 3;
    rays->device = rtcNewDevice("threads=1");
    if (!rays->device)
        return report_error(rays->log, "Embree cannot start on this machine (error %d)",
                            (int)rtcGetDeviceError(NULL));
    rtcSetDeviceErrorFunction(rays->device, embree_error, rays);
    rays->scene = rtcNewScene(rays->device);
    rtcSetSceneFlags(rays->scene, RTC_SCENE_FLAG_ROBUST); /* no ray slips between two triangles */
    rtcSetSceneBuildQuality(rays->scene, RTC_BUILD_QUALITY_HIGH);
    if (rays->solid_count)
        attach(rays, SOLID, 0, rays->solid_count);
    if (count > rays->solid_count)
        attach(rays, WITH_HOLES, rays->solid_count, count - rays->solid_count);
    rtcCommitScene(rays->scene);
    return rtcGetDeviceError(rays->device) == RTC_ERROR_NONE;
}

struct ray_scene *ray_scene_open(const struct dt_scene *scene, const struct dt_log *log)
{
    struct ray_scene *rays = malloc(sizeof *rays);
    if (rays) {
        *rays = (struct ray_scene){.data = scene, .log = log};
        srgb_decode_table(rays->linear);
    }
    if (!rays || !sort_triangles(rays))
        report_error(log, "out of memory for %u triangles", scene->index_count / 3);
    else if (build_scene(rays))
        return rays;
    ray_scene_close(rays);
    return NULL;
}

void ray_scene_close(struct ray_scene *rays)
{
    if (!rays)
        return;
    if (rays->scene)
        rtcReleaseScene(rays->scene);
    if (rays->device)
        rtcReleaseDevice(rays->device);
    free(rays->indices);
    free(rays);
}

/* ---- Queries --------------------------------------------------------------------------------- */

static void describe_hit(const struct ray_scene *rays, const struct surface_place *place,
                         struct vec3 direction, struct ray_hit *hit)
{
    const struct dt_material *material = &rays->data->materials[place->corner[0]->material];
    const struct vec3 zero = {0, 0, 0}, back = scale(direction, -1);
    struct vec3 corner[3], normal = zero;
    float texel[4], albedo[3], coordinate = 0;
    hit->position = zero;
    for (int k = 0; k < 3; k++) {
        corner[k] = vec3_of(place->corner[k]->position);
        for (int i = 0; i < 3; i++)
            coordinate = fmaxf(coordinate, fabsf(place->corner[k]->position[i]));
        hit->position = add(hit->position, scale(corner[k], place->weight[k]));
        normal = add(normal, scale(vec3_of(place->corner[k]->normal), place->weight[k]));
    }
    struct vec3 geometric = cross(subtract(corner[1], corner[0]), subtract(corner[2], corner[0]));
    float length = sqrtf(dot(geometric, geometric));
    geometric = length > 0 ? scale(geometric, 1 / length) : back;
    hit->geometric = dot(geometric, back) < 0 ? scale(geometric, -1) : geometric;
    normal = unit_or(normal, hit->geometric);
    hit->normal = dot(normal, hit->geometric) < 0 ? scale(normal, -1) : normal;
    hit->clearance = coordinate * 32 * FLT_EPSILON;
    surface_texel(rays, place, texel);
    for (int c = 0; c < 3; c++)
        albedo[c] = fminf(fmaxf(material->albedo[c] * texel[c], 0), 1);
    hit->albedo = vec3_of(albedo);
    hit->emission = vec3_of(material->emission);
}

static struct RTCRay ray_from(struct vec3 origin, struct vec3 direction, float farthest)
{
    return (struct RTCRay){
        .org_x = origin.x,
        .org_y = origin.y,
        .org_z = origin.z,
        .dir_x = direction.x,
        .dir_y = direction.y,
        .dir_z = direction.z,
        .tfar = farthest,
        .mask = UINT32_MAX,
    };
}

bool ray_closest(const struct ray_scene *rays, struct vec3 origin, struct vec3 direction,
                 struct ray_hit *hit)
{
    struct RTCRayHit query = {
        .ray = ray_from(origin, direction, INFINITY),
        .hit = {.geomID = RTC_INVALID_GEOMETRY_ID, .primID = RTC_INVALID_GEOMETRY_ID},
    };
#if RTC_VERSION_MAJOR >= 4
    rtcIntersect1(rays->scene, &query, NULL);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(rays->scene, &context, &query);
#endif
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID)
        return false;
    struct surface_place place =
        find_surface(rays, query.hit.geomID, query.hit.primID, query.hit.u, query.hit.v);
    describe_hit(rays, &place, direction, hit);
    return true;
}

bool ray_blocked(const struct ray_scene *rays, struct vec3 origin, struct vec3 direction,
                 float farthest)
{
    struct RTCRay ray = ray_from(origin, direction, farthest);
#if RTC_VERSION_MAJOR >= 4
    rtcOccluded1(rays->scene, &ray, NULL);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(rays->scene, &context, &ray);
#endif
    return ray.tfar < 0; /* Embree sets it to -inf */
}

struct vec3 ray_origin(const struct ray_hit *hit)
{
    return add(hit->position, scale(hit->geometric, hit->clearance));
}
