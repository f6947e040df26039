/* The path tracer; see tracer.h. Threads take tiles of the picture one after the other; a pixel is
 * one thread's within a call, and its samples are added in their order. */
#include "tracer.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "console.h"
#include "rays.h"

static const float pi = 3.14159265358979f;

enum {
    TILE = 16,         /* pixels per side */
    FIRST_ROULETTE = 4 /* from this leg of a path on it may end by chance */
};

struct tracer {
    struct tracer_info info;
    struct dt_frame frame;
    struct ray_scene *rays;
    uint64_t ray_count;
};

/* A thread's part of one tracer_add. */
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

/* Irradiance of the hit by light that comes straight from the source, W/m2. */
static struct vec3 direct_irradiance(struct tracer_thread *thread, const struct ray_hit *hit)
{
    const struct dt_frame *frame = &thread->tracer->frame;
    const struct dt_light *light = &frame->light;
    const struct vec3 none = {0, 0, 0}, axis = vec3_of(light->direction);
    struct vec3 origin = ray_origin(hit), way, to_light;
    float farthest, strength;
    if (light->kind == DT_LIGHT_DIRECTIONAL) {
        way = to_light = scale(axis, -1);
        farthest = INFINITY;
        strength = in_light_view(&frame->light_view, hit->position) ? 1 : 0;
    } else {
        struct vec3 path = subtract(vec3_of(light->position), hit->position);
        float square = fmaxf(dot(path, path), 1e-8f * frame->scene_radius * frame->scene_radius);
        to_light = unit_or(path, scale(axis, -1));
        way = subtract(vec3_of(light->position), origin); /* ends in the light */
        farthest = 1;
        strength = spot_falloff(light, -dot(to_light, axis)) / square;
    }
    float cosine = dot(hit->normal, to_light);
    if (!(strength > 0) || cosine <= 0 || dot(hit->geometric, to_light) <= 0)
        return none;
    thread->rays++;
    if (ray_blocked(thread->tracer->rays, origin, way, farthest))
        return none;
    return scale(vec3_of(light->color), strength * cosine);
}

/* Light that leaves the hit without having come by another surface: what it emits, as radiance, and
 * reflects of the light itself. */
static struct vec3 radiance_of(struct tracer_thread *thread, const struct ray_hit *hit,
                               bool emitted, bool reflected)
{
    struct vec3 sum = emitted ? hit->emission : (struct vec3){0, 0, 0};
    if (reflected)
        sum = add(sum, scale(multiply(hit->albedo, direct_irradiance(thread, hit)), 1 / pi));
    return sum;
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
 * the hemisphere (Malley). The frame is Duff et al.'s, 2017, listing 3. */
static struct vec3 cosine_direction(struct vec3 n, const float square[2])
{
    float disk[2], side = n.z >= 0 ? 1 : -1, a = -1 / (side + n.z), b = n.x * n.y * a;
    struct vec3 tangent = {1 + side * n.x * n.x * a, side * b, -side * n.x};
    struct vec3 bitangent = {b, side + n.y * n.y * a, -n.y};
    concentric_disk(square, disk);
    float height = sqrtf(fmaxf(1 - disk[0] * disk[0] - disk[1] * disk[1], 0));
    struct vec3 v = add(add(scale(tangent, disk[0]), scale(bitangent, disk[1])), scale(n, height));
    return unit_or(v, n);
}

/* Goes on from the hit in a direction drawn by its cosine; false when nothing is there. */
static bool next_hit(struct tracer_thread *thread, struct ray_hit *hit, const float square[2])
{
    struct vec3 direction = cosine_direction(hit->normal, square);
    if (dot(direction, hit->geometric) <= 0)
        return false; /* into the body that an interpolated normal leans over */
    thread->rays++;
    return ray_closest(thread->tracer->rays, ray_origin(hit), direction, hit);
}

/* One sample of the radiance that reaches the hit from other surfaces, averaged over the hemisphere
 * with the cosine as weight. What the k-th surface after the hit reflects has been reflected k
 * times; what it emits is direct light to the one before. */
static struct vec3 indirect_radiance(struct tracer_thread *thread, struct ray_hit hit,
                                     const struct sequence *sequence)
{
    const struct tracer_info *info = &thread->tracer->info;
    struct vec3 sum = {0, 0, 0}, share = {1, 1, 1};
    for (uint32_t k = 1; info->emission ? k - 1 <= info->last_bounce : k <= info->last_bounce;
         k++) {
        float square[2], chance[2];
        if (info->last_bounce == TRACER_UNLIMITED && k >= FIRST_ROULETTE) {
            float survival = fminf(largest(share), 0.95f);
            sequence_pair(sequence, 2 * k, chance);
            if (chance[0] >= survival)
                break;
            share = scale(share, 1 / survival);
        }
        sequence_pair(sequence, 2 * k - 1, square);
        if (!next_hit(thread, &hit, square))
            break;
        bool emitted = info->emission && k - 1 >= info->first_bounce;
        bool reflected = k >= info->first_bounce && k <= info->last_bounce;
        sum = add(sum, multiply(share, radiance_of(thread, &hit, emitted, reflected)));
        share = multiply(share, hit.albedo);
    }
    return sum;
}

/* ---- Pixels ---------------------------------------------------------------------------------- */

/* The point of the camera's view volume at normalized device coordinates. */
static void unproject(const struct dt_view *camera, const double ndc[3], double point[3])
{
    const float(*m)[4] = camera->inverse_view_projection;
    double clip[4];
    for (int row = 0; row < 4; row++)
        clip[row] = m[0][row] * ndc[0] + m[1][row] * ndc[1] + m[2][row] * ndc[2] + m[3][row];
    for (int i = 0; i < 3; i++)
        point[i] = clip[i] / clip[3];
}

/* What the camera sees at a place of the picture, in pixels from its upper left corner. The ray goes
 * from the near plane to the far one, by the very matrix that the rasterizer inverts. */
static bool camera_hit(struct tracer_thread *thread, double x, double y, struct ray_hit *hit)
{
    const struct dt_frame *frame = &thread->tracer->frame;
    double ndc[3] = {2 * x / frame->width - 1, 1 - 2 * y / frame->height, 0};
    double near[3], far[3], length = 0;
    float origin[3], direction[3];
    unproject(&frame->camera, ndc, near);
    ndc[2] = 1;
    unproject(&frame->camera, ndc, far);
    for (int i = 0; i < 3; i++)
        length += (far[i] - near[i]) * (far[i] - near[i]);
    for (int i = 0; i < 3; i++) {
        origin[i] = (float)near[i];
        direction[i] = (float)((far[i] - near[i]) / sqrt(length));
    }
    thread->rays++;
    return ray_closest(thread->tracer->rays, vec3_of(origin), vec3_of(direction), hit);
}

/* What a pixel shows of light that has come by no other surface. */
static struct vec3 first_light(struct tracer_thread *thread, const struct ray_hit *hit)
{
    const struct tracer_info *info = &thread->tracer->info;
    if (info->first_bounce > 0)
        return (struct vec3){0, 0, 0};
    return info->output == TRACER_IRRADIANCE ? direct_irradiance(thread, hit)
                                             : radiance_of(thread, hit, info->emission, true);
}

static void add_pixel(struct tracer_thread *thread, uint32_t x, uint32_t y)
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
        if (info->box_filter || i == 0) { /* through the centre, all samples see the same */
            float place[2] = {0.5f, 0.5f};
            if (info->box_filter)
                sequence_pair(&sequence, 0, place);
            found = camera_hit(thread, (double)x + place[0], (double)y + place[1], &hit);
            first = found ? first_light(thread, &hit) : (struct vec3){0, 0, 0};
        }
        struct vec3 value = first;
        if (found) {
            bool irradiance = info->output == TRACER_IRRADIANCE;
            struct vec3 factor = irradiance ? (struct vec3){pi, pi, pi} : hit.albedo;
            value = add(value, multiply(factor, indirect_radiance(thread, hit, &sequence)));
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
                add_pixel(thread, x, y);
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
    /* where no further thread can be had, fewer do the same */
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
