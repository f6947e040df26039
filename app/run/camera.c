/* Moves a camera and saves it to a scene file; see camera.h. */
#include "run/camera.h"

#include <libfyaml.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "console/console.h"
#include "base/files.h"
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

/* ---- Saving ---------------------------------------------------------------------------------- */

/* Adds to the depth what the event opens or closes; returns its token, or NULL. */
static struct fy_token *take_event(const struct fy_event *event, int *depth)
{
    switch (event->type) {
    case FYET_MAPPING_START:
        ++*depth;
        return event->mapping_start.mapping_start;
    case FYET_SEQUENCE_START:
        ++*depth;
        return event->sequence_start.sequence_start;
    case FYET_MAPPING_END:
        --*depth;
        return event->mapping_end.mapping_end;
    case FYET_SEQUENCE_END:
        --*depth;
        return event->sequence_end.sequence_end;
    case FYET_SCALAR:
        return event->scalar.value;
    default:
        return NULL;
    }
}

static bool is_camera(struct fy_token *token)
{
    size_t length = 0;
    const char *text = token ? fy_token_get_text(token, &length) : NULL;
    return text && length == strlen("camera") && memcmp(text, "camera", length) == 0;
}

/* Bytes of the camera's mapping in the text; to == 0: there is none. */
struct camera_place {
    size_t from, to;
};

/* Keys and values of the root begin at depth 1, in turn. A block mapping has no end mark: it ends with its
 * last value, before blanks and comments. */
static struct camera_place find_in_events(struct fy_parser *parser)
{
    struct camera_place place = {0};
    bool is_key = true, is_named = false, is_inside = false;
    size_t last = 0;
    int depth = 0;
    for (struct fy_event *event; !place.to && (event = fy_parser_parse(parser));) {
        int before = depth;
        struct fy_token *token = take_event(event, &depth);
        const struct fy_mark *start = token ? fy_token_start_mark(token) : NULL;
        const struct fy_mark *end = token ? fy_token_end_mark(token) : NULL;
        bool opens = depth > before, closes = depth < before;
        if (!opens && start && end && end->input_pos > start->input_pos)
            last = end->input_pos;
        if (before == 1 && opens && is_named && start) {
            is_inside = true;
            place.from = start->input_pos;
        }
        if (before == 1 && (opens || event->type == FYET_SCALAR)) {
            is_named = is_key && !opens && is_camera(token);
            is_key = !is_key;
        }
        if (closes && depth == 1 && is_inside)
            place.to = last;
        fy_parser_event_free(parser, event);
    }
    return place;
}

static bool find_camera(const char *text, size_t size, struct camera_place *place)
{
    const struct fy_parse_cfg config = {.flags = FYPCF_QUIET};
    struct fy_parser *parser = fy_parser_create(&config);
    bool good = parser && fy_parser_set_string(parser, text, size) == 0;
    *place = good ? find_in_events(parser) : (struct camera_place){0};
    fy_parser_destroy(parser);
    return place->from < place->to && place->to <= size;
}

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

bool camera_save(const struct dt_scene_camera *camera, const char *path, const struct dt_log *log)
{
    size_t size;
    struct camera_place place;
    char *text = file_read(path, &size, log);
    if (!text)
        return false;
    if (!find_camera(text, size, &place)) {
        report_error(log, "%s: has no camera to replace; nothing was written", path);
        free(text);
        return false;
    }
    char *node = camera_text(camera);
    char *whole =
        node ? format_string("%.*s%s%s", (int)place.from, text, node, text + place.to) : NULL;
    bool good = whole && file_write(path, whole, strlen(whole), log);
    if (!whole)
        report_error(log, "%s: out of memory", path);
    free(whole);
    free(node);
    free(text);
    return good;
}
