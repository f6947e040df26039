/* Moves a camera and writes it; see camera.h. */
#include "run/camera.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "console/vector.h"

/* Right, up and forward, unit and perpendicular. */
struct axes {
    struct vec3 right, up, forward;
};

static struct vec3 unit(struct vec3 v)
{
    float length = sqrtf(dot(v, v));
    return length > 0 ? scale(v, 1 / length) : v;
}

static struct axes axes_of(const struct dt_scene_camera *camera)
{
    struct axes axes;
    axes.forward = unit(subtract(vec3_of(camera->target), vec3_of(camera->eye)));
    axes.right = unit(cross(axes.forward, vec3_of(camera->up)));
    axes.up = cross(axes.right, axes.forward);
    return axes;
}

static void store(float out[3], struct vec3 v)
{
    out[0] = v.x;
    out[1] = v.y;
    out[2] = v.z;
}

void camera_move(struct dt_scene_camera *camera, float right, float up, float forward)
{
    struct axes axes = axes_of(camera);
    struct vec3 way = add(add(scale(axes.right, right), scale(unit(vec3_of(camera->up)), up)),
                          scale(axes.forward, forward));
    store(camera->eye, add(vec3_of(camera->eye), way));
    store(camera->target, add(vec3_of(camera->target), way));
}

void camera_turn(struct dt_scene_camera *camera, float right, float up)
{
    static const float steepest = 1.5f; /* radians from the horizon */
    struct axes axes = axes_of(camera);
    struct vec3 vertical = unit(vec3_of(camera->up));
    struct vec3 ahead = unit(cross(vertical, axes.right)); /* level */
    struct vec3 way = subtract(vec3_of(camera->target), vec3_of(camera->eye));
    float distance = sqrtf(dot(way, way));
    float pitch = asinf(fmaxf(-1, fminf(1, dot(axes.forward, vertical)))) + up;
    pitch = fmaxf(-steepest, fminf(steepest, pitch));
    struct vec3 level = add(scale(ahead, cosf(right)), scale(axes.right, sinf(right)));
    way = add(scale(level, cosf(pitch)), scale(vertical, sinf(pitch)));
    store(camera->target, add(vec3_of(camera->eye), scale(way, distance)));
}

void camera_orbit(struct dt_scene_camera *camera, float right, float up)
{
    struct dt_scene_camera back = *camera; /* from the target to the eye */
    memcpy(back.eye, camera->target, sizeof back.eye);
    memcpy(back.target, camera->eye, sizeof back.target);
    camera_turn(&back, right, -up);
    memcpy(camera->eye, back.target, sizeof camera->eye);
}

/* ---- Writing -------------------------------------------------------------------------------- */

/* Shortest decimal number that gives the same value after multiplication by the factor. */
static void print_number(char out[24], float number, double factor)
{
    for (int digits = 4; digits <= 9; digits++) {
        snprintf(out, 24, "%.*g", digits, (double)number / factor);
        if ((float)(strtod(out, NULL) * factor) == number)
            return;
    }
}

char *camera_text(const struct dt_scene_camera *camera)
{
    const float *vectors[3] = {camera->eye, camera->target, camera->up};
    char numbers[3][3][24], degrees[24];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            print_number(numbers[i][k], vectors[i][k], 1);
    print_number(degrees, camera->fov_y, M_PI / 180);
    return format_string("{eye: [%s, %s, %s], target: [%s, %s, %s], up: [%s, %s, %s], fov_y: %s}",
                         numbers[0][0], numbers[0][1], numbers[0][2], numbers[1][0], numbers[1][1],
                         numbers[1][2], numbers[2][0], numbers[2][1], numbers[2][2], degrees);
}
