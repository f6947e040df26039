/* Converts cameras and lights; see camera_light.h. Files have degrees, scenes radians. */
#include "camera_light.h"

#include <math.h>
#include <string.h>

static bool failed(const struct reader *reader, int errors)
{
    return reader && reader->errors > errors;
}

static void copy3(const struct key *key, float out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = (float)key->number[i];
}

static void tell3(struct key *key, const float in[3])
{
    key->given = true;
    for (int i = 0; i < 3; i++)
        key->number[i] = (double)in[i];
}

static float radians(double degrees)
{
    return (float)(degrees * M_PI / 180);
}

static double degrees(float radians)
{
    return (double)radians * 180 / M_PI;
}

/* The unit vector along to - from; false if they coincide. */
static bool direction3(const double from[3], const double to[3], float out[3])
{
    double v[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    if (!(length > 0))
        return false;
    for (int i = 0; i < 3; i++)
        out[i] = (float)(v[i] / length);
    return true;
}

/* ---- Camera ---------------------------------------------------------------------------------- */

void camera_keys(struct key keys[CAMERA_KEYS])
{
    static const struct key all[CAMERA_KEYS] = {
        [CAMERA_EYE] = KEY_OF_NUMBERS("eye", true, 3, -FAR, FAR, 0),
        [CAMERA_TARGET] = KEY_OF_NUMBERS("target", true, 3, -FAR, FAR, 0),
        [CAMERA_UP] = KEY_OF_NUMBERS("up", false, 3, -FAR, FAR, 0, 1, 0),
        [CAMERA_FOV_Y] = KEY_OF_NUMBERS("fov_y", true, 1, 1, 170, 40),
    };
    memcpy(keys, all, sizeof all);
}

void camera_take(struct reader *reader, int errors, const struct key keys[CAMERA_KEYS],
                 struct fy_node *place, struct dt_scene_camera *camera)
{
    float view[3], up[3];
    const double zero[3] = {0};
    if (failed(reader, errors))
        return;
    if (!direction3(keys[CAMERA_EYE].number, keys[CAMERA_TARGET].number, view)) {
        reader_report(reader, keys[CAMERA_TARGET].node ? keys[CAMERA_TARGET].node : place,
                      "`target` is where `eye` is; move one of them");
    } else if (!direction3(zero, keys[CAMERA_UP].number, up) ||
               fabsf(view[0] * up[0] + view[1] * up[1] + view[2] * up[2]) > 0.9999f) {
        reader_report(reader, keys[CAMERA_UP].node ? keys[CAMERA_UP].node : place,
                      "`up` must not be zero nor lie along the line of sight; give another `up`");
    }
    copy3(&keys[CAMERA_EYE], camera->eye);
    copy3(&keys[CAMERA_TARGET], camera->target);
    copy3(&keys[CAMERA_UP], camera->up);
    camera->fov_y = radians(keys[CAMERA_FOV_Y].number[0]);
}

void camera_tell(const struct dt_scene_camera *camera, struct key keys[CAMERA_KEYS])
{
    tell3(&keys[CAMERA_EYE], camera->eye);
    tell3(&keys[CAMERA_TARGET], camera->target);
    tell3(&keys[CAMERA_UP], camera->up);
    keys[CAMERA_FOV_Y].given = true;
    keys[CAMERA_FOV_Y].number[0] = degrees(camera->fov_y);
}

/* ---- Light ----------------------------------------------------------------------------------- */

int light_keys(int kind, struct key keys[LIGHT_KEYS])
{
    static const struct key sun[] = {
        [SUN_DIRECTION] = KEY_OF_NUMBERS("direction", true, 3, -FAR, FAR, 0),
        [SUN_IRRADIANCE] = KEY_OF_NUMBERS("irradiance", true, 3, 0, FAR, 0),
        [SUN_OPENING_MIN] = KEY_OF_NUMBERS("opening_min", false, 3, -FAR, FAR, -FAR, -FAR, -FAR),
        [SUN_OPENING_MAX] = KEY_OF_NUMBERS("opening_max", false, 3, -FAR, FAR, FAR, FAR, FAR),
        [SUN_KIND] = {.name = "kind", .type = KEY_TEXT, .required = true},
    };
    static const struct key spot[] = {
        [SPOT_POSITION] = KEY_OF_NUMBERS("position", true, 3, -FAR, FAR, 0),
        [SPOT_TARGET] = KEY_OF_NUMBERS("target", false, 3, -FAR, FAR, 0),
        [SPOT_DIRECTION] = KEY_OF_NUMBERS("direction", false, 3, -FAR, FAR, 0),
        /* one perspective covers less than half of space */
        [SPOT_CONE] = KEY_OF_NUMBERS("cone", true, 2, 0, 85, 0),
        [SPOT_INTENSITY] = KEY_OF_NUMBERS("intensity", true, 3, 0, FAR, 0),
        [SPOT_KIND] = {.name = "kind", .type = KEY_TEXT, .required = true},
    };
    if (kind == DT_LIGHT_SPOT) {
        memcpy(keys, spot, sizeof spot);
        return DT_ARRAY_COUNT(spot);
    }
    memcpy(keys, sun, sizeof sun);
    return DT_ARRAY_COUNT(sun);
}

static void take_directional(struct reader *reader, int errors, const struct key *keys,
                             struct fy_node *place, struct scene_light *light)
{
    const struct key *low = &keys[SUN_OPENING_MIN], *high = &keys[SUN_OPENING_MAX];
    const double zero[3] = {0};
    if (low->given != high->given)
        reader_report(reader, place, "`opening_min` and `opening_max` go together");
    if (failed(reader, errors))
        return;
    for (int i = 0; i < 3; i++) {
        if (low->number[i] > high->number[i]) {
            reader_report(reader, low->node ? low->node : place,
                          "`opening_min` must not lie above `opening_max`");
            break;
        }
    }
    if (!direction3(zero, keys[SUN_DIRECTION].number, light->direction))
        reader_report(reader, keys[SUN_DIRECTION].node ? keys[SUN_DIRECTION].node : place,
                      "`direction` must not be zero");
    copy3(low, light->opening_min);
    copy3(high, light->opening_max);
    copy3(&keys[SUN_IRRADIANCE], light->color);
}

static void take_spot(struct reader *reader, int errors, const struct key *keys,
                      struct fy_node *place, struct scene_light *light)
{
    const struct key *target = &keys[SPOT_TARGET], *direction = &keys[SPOT_DIRECTION];
    if (target->given == direction->given)
        reader_report(reader, place, "a spot light takes either `target` or `direction`");
    if (failed(reader, errors))
        return;
    const double *position = keys[SPOT_POSITION].number, zero[3] = {0};
    if (target->given ? !direction3(position, target->number, light->direction)
                      : !direction3(zero, direction->number, light->direction)) {
        struct fy_node *node = target->given ? target->node : direction->node;
        reader_report(reader, node ? node : place, "%s",
                      target->given ? "`target` is where `position` is; move one of them"
                                    : "`direction` must not be zero");
    }
    const double *cone = keys[SPOT_CONE].number;
    if (cone[1] < 0.1 || cone[0] > cone[1])
        reader_report(
            reader, keys[SPOT_CONE].node ? keys[SPOT_CONE].node : place,
            "`cone` is [inner, outer] with 0 <= inner <= outer and outer at least 0.1 degrees");
    light->aimed = target->given;
    copy3(target, light->target);
    copy3(&keys[SPOT_POSITION], light->position);
    copy3(&keys[SPOT_INTENSITY], light->color);
    for (int i = 0; i < 2; i++)
        light->cone[i] = radians(cone[i]);
}

void light_take(struct reader *reader, int errors, int kind, const struct key keys[LIGHT_KEYS],
                struct fy_node *place, struct scene_light *light)
{
    light->kind = kind;
    if (kind == DT_LIGHT_SPOT)
        take_spot(reader, errors, keys, place, light);
    else
        take_directional(reader, errors, keys, place, light);
}

void light_tell(const struct scene_light *light, struct key keys[LIGHT_KEYS])
{
    if (light->kind == DT_LIGHT_DIRECTIONAL) {
        tell3(&keys[SUN_DIRECTION], light->direction);
        tell3(&keys[SUN_IRRADIANCE], light->color);
        tell3(&keys[SUN_OPENING_MIN], light->opening_min);
        tell3(&keys[SUN_OPENING_MAX], light->opening_max);
        return;
    }
    tell3(&keys[SPOT_POSITION], light->position);
    tell3(&keys[SPOT_INTENSITY], light->color);
    if (light->aimed)
        tell3(&keys[SPOT_TARGET], light->target);
    else
        tell3(&keys[SPOT_DIRECTION], light->direction);
    keys[SPOT_CONE].given = true;
    for (int i = 0; i < 2; i++)
        keys[SPOT_CONE].number[i] = degrees(light->cone[i]);
}
