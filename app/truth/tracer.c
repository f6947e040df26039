/* The path tracer; see tracer.h. Threads take tiles of the picture one after the other; a pixel is
 * one thread's within a call, and its samples are added in their order. */
#include "truth/tracer.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "console/console.h"
#include "truth/rays.h"

static const float pi = 3.14159265358979f;

enum {
    TILE = 16,         /* pixels per side */
    FIRST_ROULETTE = 4 /* first leg of a path at which Russian roulette may end it */
};

/* Pairs of dimensions; the k-th leg of a path, k from 1, adds 2 k to its two. */
enum { PAIR_PIXEL, PAIR_LIGHT, PAIR_DIRECTION = 0, PAIR_ROULETTE = 1 };

struct tracer {
    struct tracer_info info;
    struct dt_frame frame;
    struct ray_scene *rays;
    uint64_t ray_count;
};

/* Work of one thread in tracer_add. */
struct tracer_thread {
    struct tracer *tracer;
    struct film *film;
    uint32_t samples;
    atomic_uint *next_tile;
    uint64_t rays;
};

/* ---- Light ----------------------------------------------------------------------------------- */

/* Fraction of a spot's intensity at the cosine of the angle to its axis; as in the pipelines, full
 * within the inner half angle, none beyond the outer, a smooth step of the cosine between. */
static float spot_falloff(const struct dt_light *light, float cosine)
{
    float width = fmaxf(light->cos_inner - light->cos_outer, 1e-6f);
    float t = fminf(fmaxf((cosine - light->cos_outer) / width, 0), 1);
    return t * t * (3 - 2 * t);
}

/* Whether the light's view, which bounds a directional light, holds x. */
static bool in_light_view(const struct dt_view *view, struct vec3 x)
{
    const float(*m)[4] = view->view_projection;
    float w = m[0][3] * x.x + m[1][3] * x.y + m[2][3] * x.z + m[3][3];
    for (int axis = 0; axis < 2; axis++) {
        float clip = m[0][axis] * x.x + m[1][axis] * x.y + m[2][axis] * x.z + m[3][axis];
        if (!(fabsf(clip) < w))
            return false;
    }
    return true;
}

/* Irradiance of the hit by light that comes straight from the source, W/m2, if nothing stands
 * between. *way leads from where a ray leaves the hit to the source, which lies at 1 or infinitely
 * far. */
static struct vec3 unshadowed_irradiance(const struct tracer_thread *thread,
                                         const struct ray_hit *hit, struct vec3 *way)
{
    const struct dt_frame *frame = &thread->tracer->frame;
    const struct dt_light *light = &frame->light;
    const struct vec3 none = {0, 0, 0}, axis = vec3_of(light->direction);
    struct vec3 to_light = scale(axis, -1);
    float strength;
    if (light->kind == DT_LIGHT_DIRECTIONAL) {
        *way = to_light;
        strength = in_light_view(&frame->light_view, hit->position) ? 1 : 0;
    } else {
        struct vec3 path = subtract(vec3_of(light->position), hit->position);
        float square = fmaxf(dot(path, path), 1e-8f * frame->scene_radius * frame->scene_radius);
        to_light = unit_or(path, to_light);
        *way = subtract(vec3_of(light->position), ray_origin(hit));
        strength = spot_falloff(light, -dot(to_light, axis)) / square;
    }
    float cosine = dot(hit->normal, to_light);
    if (!(strength > 0) || cosine <= 0 || dot(hit->geometric, to_light) <= 0)
        return none;
    return scale(vec3_of(light->color), strength * cosine);
}

static struct vec3 direct_irradiance(struct tracer_thread *thread, const struct ray_hit *hit)
{
    bool directional = thread->tracer->frame.light.kind == DT_LIGHT_DIRECTIONAL;
    const struct vec3 none = {0, 0, 0};
    struct vec3 way, irradiance = unshadowed_irradiance(thread, hit, &way);
    if (largest(irradiance) <= 0)
        return none;
    thread->rays++;
    bool blocked =
        ray_blocked(thread->tracer->rays, ray_origin(hit), way, directional ? INFINITY : 1);
    return blocked ? none : irradiance;
}

/* Radiance that a surface reflects of the irradiance. */
static struct vec3 reflect(const struct ray_hit *hit, struct vec3 irradiance)
{
    return scale(multiply(hit->albedo, irradiance), 1 / pi);
}

/* ---- Points that the light sees -------------------------------------------------------------- */

/* World position of a point given in normalized device coordinates of the view. */
static void unproject(const struct dt_view *view, const double ndc[3], double point[3])
{
    const float(*m)[4] = view->inverse_view_projection;
    double clip[4];
    for (int row = 0; row < 4; row++)
        clip[row] = m[0][row] * ndc[0] + m[1][row] * ndc[1] + m[2][row] * ndc[2] + m[3][row];
    for (int i = 0; i < 3; i++)
        point[i] = clip[i] / clip[3];
}

/* Two unit vectors that make a frame with the unit vector n (Duff et al. 2017, listing 3). */
static void tangent_frame(struct vec3 n, struct vec3 *tangent, struct vec3 *bitangent)
{
    float side = n.z >= 0 ? 1 : -1, a = -1 / (side + n.z), b = n.x * n.y * a;
    *tangent = (struct vec3){1 + side * n.x * n.x * a, side * b, -side * n.x};
    *bitangent = (struct vec3){b, side + n.y * n.y * a, -n.y};
}

/* Follows one ray from the light, drawn evenly over the cross-section of a directional light or the
 * solid angle of a spot's cone, to the first surface; its hit is turned to the light. */
static bool lit_point(struct tracer_thread *thread, const float square[2], struct ray_hit *hit)
{
    const struct dt_frame *frame = &thread->tracer->frame;
    const struct dt_light *light = &frame->light;
    struct vec3 origin = vec3_of(light->position), direction = vec3_of(light->direction);
    if (light->kind == DT_LIGHT_DIRECTIONAL) {
        double point[3];
        unproject(&frame->light_view, (double[3]){2 * square[0] - 1, 2 * square[1] - 1, 0}, point);
        origin = (struct vec3){(float)point[0], (float)point[1], (float)point[2]};
    } else {
        struct vec3 tangent, bitangent;
        float below = square[0] * (1 - light->cos_outer), angle = 2 * pi * square[1];
        float sine = sqrtf(below * (2 - below)); /* of the angle whose cosine is 1 - below */
        tangent_frame(direction, &tangent, &bitangent);
        direction =
            unit_or(add(scale(direction, 1 - below), add(scale(tangent, sine * cosf(angle)),
                                                         scale(bitangent, sine * sinf(angle)))),
                    direction);
    }
    thread->rays++;
    return ray_closest(thread->tracer->rays, origin, direction, hit);
}

/* Density of the points of lit_point on the surface at a hit, per unit area. */
static float lit_density(const struct tracer_thread *thread, const struct ray_hit *hit)
{
    const struct dt_light *light = &thread->tracer->frame.light;
    if (light->kind == DT_LIGHT_DIRECTIONAL)
        return fabsf(dot(hit->geometric, vec3_of(light->direction))) / light->area;
    struct vec3 path = subtract(hit->position, vec3_of(light->position));
    float square = dot(path, path), solid_angle = 2 * pi * (1 - light->cos_outer);
    return fabsf(dot(hit->geometric, path)) / (square * sqrtf(square) * solid_angle);
}

/* Light that the source brings to a point and that goes on from there to a hit can be found in two
 * ways: by a direction from the hit, drawn by its cosine, that happens to meet the point, or by a
 * point that the light sees, joined to the hit. Each way counts by its share of the density with
 * which both find the point (the balance heuristic of Veach, Guibas 1995), and whichever way found
 * it, that leaves this factor of the radiance. */
static float share_of_point(const struct tracer_thread *thread, const struct ray_hit *hit,
                            const struct ray_hit *point)
{
    struct vec3 path = subtract(point->position, hit->position);
    float square = dot(path, path);
    float cosines = dot(hit->normal, path) * -dot(point->geometric, path); /* times `square` */
    if (cosines <= 0)
        return 0;
    return cosines / (cosines + pi * square * square * lit_density(thread, point));
}

/* The second way: radiance at the hit from a point that the light sees, averaged over the
 * hemisphere with the cosine as weight. */
static struct vec3 joined_radiance(struct tracer_thread *thread, const struct ray_hit *hit,
                                   const struct ray_hit *point)
{
    const struct vec3 none = {0, 0, 0};
    struct vec3 ignored, origin = ray_origin(hit), way = subtract(ray_origin(point), origin);
    float share = dot(hit->geometric, way) > 0 ? share_of_point(thread, hit, point) : 0;
    struct vec3 radiance =
        scale(reflect(point, unshadowed_irradiance(thread, point, &ignored)), share);
    if (largest(radiance) <= 0)
        return none;
    thread->rays++;
    return ray_blocked(thread->tracer->rays, origin, way, 1) ? none : radiance;
}

/* ---- Paths ----------------------------------------------------------------------------------- */

/* Maps the unit square to the unit disk, strata to strata of equal area (Shirley, Chiu 1997). */
static void concentric_disk(const float square[2], float disk[2])
{
    float a = 2 * square[0] - 1, b = 2 * square[1] - 1, radius, angle;
    if (fabsf(a) > fabsf(b)) {
        radius = a;
        angle = pi / 4 * (b / a);
    } else {
        radius = b;
        angle = b != 0 ? pi / 2 - pi / 4 * (a / b) : 0;
    }
    disk[0] = radius * cosf(angle);
    disk[1] = radius * sinf(angle);
}

/* A direction about the unit vector n with the density cosine / pi: a point of the disk, lifted to
 * the hemisphere (Malley). */
static struct vec3 cosine_direction(struct vec3 n, const float square[2])
{
    struct vec3 tangent, bitangent;
    float disk[2];
    tangent_frame(n, &tangent, &bitangent);
    concentric_disk(square, disk);
    float height = sqrtf(fmaxf(1 - disk[0] * disk[0] - disk[1] * disk[1], 0));
    struct vec3 v = add(add(scale(tangent, disk[0]), scale(bitangent, disk[1])), scale(n, height));
    return unit_or(v, n);
}

/* Goes on from the hit in a direction drawn by its cosine; false when nothing is there. */
static bool next_hit(struct tracer_thread *thread, const struct ray_hit *hit, const float square[2],
                     struct ray_hit *next)
{
    struct vec3 direction = cosine_direction(hit->normal, square);
    if (dot(direction, hit->geometric) <= 0)
        return false; /* below the surface, because the interpolated normal is tilted */
    thread->rays++;
    return ray_closest(thread->tracer->rays, ray_origin(hit), direction, next);
}

/* Russian roulette: whether the path continues; divides *weight by the probability. */
static bool survives(const struct sequence *sequence, uint32_t pair, struct vec3 *weight)
{
    float survival = fminf(largest(*weight), 0.95f), chance[2];
    sequence_pair(sequence, pair, chance);
    *weight = scale(*weight, 1 / survival);
    return chance[0] < survival;
}

/* One sample of the radiance that reaches the hit from other surfaces, averaged over the hemisphere
 * with the cosine as weight. What the k-th surface after the hit reflects of the source has been
 * reflected k times; what it emits is direct light to the one before. */
static struct vec3 indirect_radiance(struct tracer_thread *thread, struct ray_hit hit,
                                     const struct sequence *sequence)
{
    const struct tracer_info *info = &thread->tracer->info;
    struct vec3 sum = {0, 0, 0}, weight = {1, 1, 1};
    struct ray_hit point, next;
    float square[2];
    bool joins = false;
    if (info->last_bounce > 0) {
        sequence_pair(sequence, PAIR_LIGHT, square);
        joins = lit_point(thread, square, &point);
    }
    for (uint32_t k = 1; info->emission ? k - 1 <= info->last_bounce : k <= info->last_bounce;
         k++, hit = next) {
        bool emitted = info->emission && k - 1 >= info->first_bounce;
        bool reflected = k >= info->first_bounce && k <= info->last_bounce;
        if (info->last_bounce == TRACER_UNLIMITED && k >= FIRST_ROULETTE &&
            !survives(sequence, PAIR_ROULETTE + 2 * k, &weight))
            break;
        if (joins && reflected)
            sum = add(sum, multiply(weight, joined_radiance(thread, &hit, &point)));
        sequence_pair(sequence, PAIR_DIRECTION + 2 * k, square);
        if (!next_hit(thread, &hit, square, &next))
            break;
        if (emitted)
            sum = add(sum, multiply(weight, next.emission));
        if (reflected) {
            struct vec3 radiance = reflect(&next, direct_irradiance(thread, &next));
            radiance = scale(radiance, share_of_point(thread, &hit, &next));
            sum = add(sum, multiply(weight, radiance));
        }
        weight = multiply(weight, next.albedo);
    }
    return sum;
}

/* ---- Pixels ---------------------------------------------------------------------------------- */

/* From the near plane to the far one, by the very matrix that the rasterizer inverts. */
void tracer_camera_ray(const struct dt_frame *frame, double x, double y, float origin[3],
                       float direction[3])
{
    double ndc[3] = {2 * x / frame->width - 1, 1 - 2 * y / frame->height, 0};
    double near[3], far[3], length = 0;
    unproject(&frame->camera, ndc, near);
    ndc[2] = 1;
    unproject(&frame->camera, ndc, far);
    for (int i = 0; i < 3; i++)
        length += (far[i] - near[i]) * (far[i] - near[i]);
    for (int i = 0; i < 3; i++) {
        origin[i] = (float)near[i];
        direction[i] = (float)((far[i] - near[i]) / sqrt(length));
    }
}

/* Closest hit of the camera's ray through a place of the picture. */
static bool camera_hit(struct tracer_thread *thread, double x, double y, struct ray_hit *hit)
{
    float origin[3], direction[3];
    tracer_camera_ray(&thread->tracer->frame, x, y, origin, direction);
    thread->rays++;
    return ray_closest(thread->tracer->rays, vec3_of(origin), vec3_of(direction), hit);
}

/* Direct light and emission at a pixel. */
static struct vec3 first_light(struct tracer_thread *thread, const struct ray_hit *hit)
{
    const struct tracer_info *info = &thread->tracer->info;
    if (info->first_bounce > 0)
        return (struct vec3){0, 0, 0};
    struct vec3 irradiance = direct_irradiance(thread, hit);
    if (info->output == TRACER_IRRADIANCE)
        return irradiance;
    struct vec3 radiance = reflect(hit, irradiance);
    return info->emission ? add(radiance, hit->emission) : radiance;
}

/* In place of indirect_radiance. */
static struct vec3 radiance_of_vpls(struct tracer_thread *thread, const struct ray_hit *hit)
{
    const struct tracer *tracer = thread->tracer;
    float closest = 1e-8f * tracer->frame.scene_radius * tracer->frame.scene_radius;
    return scale(vpls_irradiance(tracer->info.vpls, tracer->rays, hit, closest, &thread->rays),
                 1 / pi);
}

static void add_traced_pixel(struct tracer_thread *thread, uint32_t x, uint32_t y)
{
    const struct tracer_info *info = &thread->tracer->info;
    struct film *film = thread->film;
    size_t pixel = (size_t)y * film->width + x;
    struct sequence sequence = {info->sequence, sequence_seed(info->seed, (uint32_t)pixel), 0};
    struct ray_hit hit;
    struct vec3 first = {0, 0, 0};
    bool found = false;
    for (uint32_t i = 0; i < thread->samples; i++) {
        sequence.sample = film->samples + i;
        if (info->box_filter || i == 0) { /* rays through the centre have the same hit */
            float place[2] = {0.5f, 0.5f};
            if (info->box_filter)
                sequence_pair(&sequence, PAIR_PIXEL, place);
            found = camera_hit(thread, (double)x + place[0], (double)y + place[1], &hit);
            first = found ? first_light(thread, &hit) : (struct vec3){0, 0, 0};
        }
        struct vec3 value = first;
        if (found) {
            bool irradiance = info->output == TRACER_IRRADIANCE;
            struct vec3 factor = irradiance ? (struct vec3){pi, pi, pi} : hit.albedo;
            struct vec3 radiance = info->vpls->count ? radiance_of_vpls(thread, &hit)
                                                     : indirect_radiance(thread, hit, &sequence);
            value = add(value, multiply(factor, radiance));
        }
        film_add(film, pixel, sequence.sample, (float[3]){value.x, value.y, value.z});
    }
}

static uint32_t tile_count(uint32_t pixels)
{
    return (pixels + TILE - 1) / TILE;
}

static void *work(void *user)
{
    struct tracer_thread *thread = user;
    const struct film *film = thread->film;
    uint32_t columns = tile_count(film->width), rows = tile_count(film->height);
    for (;;) {
        uint32_t tile = atomic_fetch_add(thread->next_tile, 1);
        if (tile >= columns * rows)
            return NULL;
        uint32_t left = tile % columns * TILE, top = tile / columns * TILE;
        for (uint32_t y = top; y < top + TILE && y < film->height; y++)
            for (uint32_t x = left; x < left + TILE && x < film->width; x++)
                add_traced_pixel(thread, x, y);
    }
}

static uint32_t processors(void)
{
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) != 0)
        return 1;
    return (uint32_t)CPU_COUNT(&set);
}

bool tracer_add(struct tracer *tracer, struct film *film, uint32_t samples)
{
    uint32_t tiles = tile_count(film->width) * tile_count(film->height), started = 1;
    uint32_t count = tracer->info.threads < tiles ? tracer->info.threads : tiles;
    atomic_uint next_tile = 0;
    struct tracer_thread *parts = calloc(count, sizeof *parts);
    pthread_t *threads = calloc(count, sizeof *threads);
    if (!parts || !threads) {
        report_error(tracer->info.log, "out of memory for %u threads", count);
        free(parts);
        free(threads);
        return false;
    }
    for (uint32_t i = 0; i < count; i++)
        parts[i] = (struct tracer_thread){tracer, film, samples, &next_tile, 0};
    /* if no more threads can be started, fewer do the work */
    while (started < count && pthread_create(&threads[started], NULL, work, &parts[started]) == 0)
        started++;
    work(&parts[0]);
    for (uint32_t i = 0; i < started; i++) {
        if (i > 0)
            pthread_join(threads[i], NULL);
        tracer->ray_count += parts[i].rays;
    }
    film->samples += samples;
    free(parts);
    free(threads);
    return true;
}

/* ---- Open and close -------------------------------------------------------------------------- */

struct tracer *tracer_open(const struct tracer_info *info)
{
    struct tracer *tracer = calloc(1, sizeof *tracer);
    if (!tracer) {
        report_error(info->log, "out of memory");
        return NULL;
    }
    tracer->info = *info;
    tracer->frame = *info->frame;
    if (info->threads == 0)
        tracer->info.threads = processors();
    tracer->rays = ray_scene_open(info->scene, info->log);
    if (tracer->rays)
        return tracer;
    tracer_close(tracer);
    return NULL;
}

void tracer_close(struct tracer *tracer)
{
    if (!tracer)
        return;
    ray_scene_close(tracer->rays);
    free(tracer);
}

uint64_t tracer_rays(const struct tracer *tracer)
{
    return tracer->ray_count;
}
