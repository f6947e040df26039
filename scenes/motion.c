/* Motion files: keyframes of camera and light, and the interpolation; see motion.h.
 *
 *   interpolation: catmull_rom     or linear
 *   frames_per_second: 24          then `at` is in seconds; without it, in frames, 60 a second
 *   keys:
 *     - {at: 0, camera: {eye: [0, 1, 3]}, light: {target: [-1, 0, 0]}}
 *     - {at: 12, camera: {eye: [1, 1, 3]}}
 *     - {at: 24, camera: {eye: [1, 1, 2], fov_y: 50}, light: {target: [1, 0, 0]}}
 *
 * `camera` and `light` have the keys, units and ranges of a scene file, all optional, but no
 * `kind`. Each value is interpolated on its own between the keyframes that name it; before the
 * first and after the last of these it is constant. A value that no keyframe names is the scene's.
 *
 * catmull_rom is a cubic Hermite spline (Catmull, Rom 1974). The slope at a key is that of the line
 * between its neighbours, at either end that of the line to its one neighbour. Slopes are over
 * time, so keys need not be evenly spaced. The spline passes through the keys, and may overshoot
 * between them. */
#include "motion.h"

#include "camera_light.h"
#include "base/log.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_FRAMES = 1000000, FRAMES_PER_SECOND = 60, GROUP_KEYS = LIGHT_KEYS };
_Static_assert((int)GROUP_KEYS >= (int)CAMERA_KEYS, "keys of either group");

/* One value of the camera or the light at the keyframes that name it. */
struct track {
    struct track_key {
        double frame;
        double value[3];
        struct fy_node *node; /* while the file is read */
    } * keys;                 /* by frame; owned */
    uint32_t count;
};

/* All tracks of the camera or of the light, as many as it has keys. */
struct group {
    struct track tracks[GROUP_KEYS];
    struct key base[GROUP_KEYS]; /* the scene's values */
    int count;
    bool moves;
};

struct motion {
    char *path;
    bool linear;
    double frames_per_second;
    int light_kind;
    uint32_t frames;
    struct group camera, light;
};

/* ---- Between the keys ------------------------------------------------------------------------ */

/* Slope of one component, at a key. */
static double slope(const struct track *track, uint32_t i, int component)
{
    const struct track_key *before = &track->keys[i > 0 ? i - 1 : 0];
    const struct track_key *after = &track->keys[i + 1 < track->count ? i + 1 : i];
    return (after->value[component] - before->value[component]) / (after->frame - before->frame);
}

/* The last key at or before the frame; the first key for frames before it. */
static uint32_t key_before(const struct track *track, double frame)
{
    uint32_t i = 0;
    while (i + 1 < track->count && track->keys[i + 1].frame <= frame)
        i++;
    return i;
}

static void track_at(const struct track *track, bool linear, double frame, double value[3])
{
    uint32_t i = key_before(track, frame);
    const struct track_key *from = &track->keys[i], *to = from + 1;
    memcpy(value, from->value, sizeof from->value);
    if (frame <= from->frame || i + 1 == track->count)
        return;
    double length = to->frame - from->frame, t = (frame - from->frame) / length;
    for (int k = 0; k < 3; k++) {
        double rise = to->value[k] - from->value[k];
        if (linear) {
            value[k] += rise * t;
            continue;
        }
        /* Hermite's cubic, relative to the first key */
        double out = slope(track, i, k) * length, in = slope(track, i + 1, k) * length;
        value[k] += t * (out + t * (3 * rise - 2 * out - in + t * (out + in - 2 * rise)));
    }
}

/* The group's keys in a frame. The node of a moving key is that of its keyframe, for errors while
 * the file is read. */
static void group_at(const struct group *group, bool linear, double frame,
                     struct key keys[GROUP_KEYS])
{
    memcpy(keys, group->base, sizeof group->base);
    for (int i = 0; i < group->count; i++) {
        const struct track *track = &group->tracks[i];
        if (track->count == 0)
            continue;
        track_at(track, linear, frame, keys[i].number);
        keys[i].node = track->keys[key_before(track, frame)].node;
    }
}

void motion_at(const struct motion *motion, uint32_t frame, struct dt_scene_camera *camera,
               struct scene_light *light)
{
    struct key keys[GROUP_KEYS];
    if (motion->camera.moves) {
        group_at(&motion->camera, motion->linear, frame, keys);
        camera_take(NULL, 0, keys, NULL, camera);
    }
    if (motion->light.moves) {
        group_at(&motion->light, motion->linear, frame, keys);
        light_take(NULL, 0, motion->light_kind, keys, NULL, light);
    }
}

static void compose(const struct scene *scene, uint32_t index, uint32_t width, uint32_t height,
                    struct dt_frame *frame)
{
    struct scene moved = *scene;
    if (scene->motion)
        motion_at(scene->motion, index, &moved.camera, &moved.light);
    scene_frame(&moved, width, height, frame);
}

void scene_frame_at(const struct scene *scene, uint32_t index, uint32_t width, uint32_t height,
                    struct dt_frame *frame)
{
    struct dt_frame before = {.index = 0};
    double rate = scene->motion ? scene->motion->frames_per_second : FRAMES_PER_SECOND;
    if (index > 0)
        compose(scene, index - 1, width, height, &before);
    compose(scene, index, width, height, frame);
    frame->previous_camera = before.camera;
    frame->index = index;
    frame->time = (float)(index / rate);
}

/* ---- Reading --------------------------------------------------------------------------------- */

struct reading {
    struct motion *motion;
    double frames_per_unit, last_frame;
    bool out_of_memory;
};

static void add_keyframe(struct reading *reading, struct track *track, double frame,
                         const struct key *key)
{
    struct track_key *grown = realloc(track->keys, (track->count + 1) * sizeof *grown);
    if (!grown) {
        reading->out_of_memory = true;
        return;
    }
    track->keys = grown;
    grown[track->count] = (struct track_key){.frame = frame, .node = key->node};
    memcpy(grown[track->count++].value, key->number, sizeof key->number);
}

/* `camera` or `light` of one keyframe. */
static void read_group(struct reader *reader, struct reading *reading, struct group *group,
                       const struct key *self, double frame)
{
    struct key keys[GROUP_KEYS];
    memcpy(keys, group->base, sizeof keys);
    for (int i = 0; i < group->count; i++)
        keys[i].required = keys[i].given = false;
    reader_mapping(reader, self->node, self->name_node, self->name, keys, (size_t)group->count);
    for (int i = 0; i < group->count; i++) {
        if (keys[i].given)
            add_keyframe(reading, &group->tracks[i], frame, &keys[i]);
        group->moves |= keys[i].given;
    }
}

static void read_keyframe(struct reader *reader, struct reading *reading, struct fy_node *node)
{
    enum { AT, CAMERA, LIGHT, COUNT };
    struct key keys[COUNT] = {
        [AT] = KEY_OF_NUMBERS("at", true, 1, 0, MAX_FRAMES, 0),
        [CAMERA] = {.name = "camera", .type = KEY_MAPPING},
        [LIGHT] = {.name = "light", .type = KEY_MAPPING},
    };
    struct motion *motion = reading->motion;
    struct fy_node_pair *first =
        fy_node_is_mapping(node) ? fy_node_mapping_get_by_index(node, 0) : NULL;
    if (!first) {
        reader_report(reader, node, "a keyframe is a mapping with `at`, `camera` and `light`");
        return;
    }
    int errors = reader->errors;
    reader_mapping(reader, node, fy_node_pair_key(first), "the keyframe", keys, COUNT);
    double frame = keys[AT].number[0] * reading->frames_per_unit;
    if (reader->errors == errors && frame > MAX_FRAMES)
        reader_report(reader, keys[AT].node, "`at` is frame %.0f, but the limit is %d", frame,
                      MAX_FRAMES);
    else if (reader->errors == errors && frame <= reading->last_frame)
        reader_report(reader, keys[AT].node, "`at` must grow from keyframe to keyframe");
    reading->last_frame = frame;
    if (keys[CAMERA].node && fy_node_is_mapping(keys[CAMERA].node))
        read_group(reader, reading, &motion->camera, &keys[CAMERA], frame);
    if (keys[LIGHT].node && fy_node_is_mapping(keys[LIGHT].node))
        read_group(reader, reading, &motion->light, &keys[LIGHT], frame);
}

/* A motion's `target` or `direction` of a spot replaces the scene's. */
static void replace_aim(struct reader *reader, struct motion *motion, struct fy_node *place)
{
    struct group *light = &motion->light;
    if (motion->light_kind != DT_LIGHT_SPOT)
        return;
    bool target = light->tracks[SPOT_TARGET].count, direction = light->tracks[SPOT_DIRECTION].count;
    if (target && direction)
        reader_report(reader, place, "a motion moves either `target` or `direction` of a light");
    if (target || direction) {
        light->base[SPOT_TARGET].given = target;
        light->base[SPOT_DIRECTION].given = direction;
    }
}

/* Whether the group's numbers are valid in this frame: ranges and combinations. */
static bool try_frame(struct reader *reader, const struct motion *motion, const struct group *group,
                      uint32_t frame, struct fy_node *place)
{
    struct key keys[GROUP_KEYS];
    struct dt_scene_camera camera;
    struct scene_light light;
    int errors = reader->errors;
    snprintf(reader->context, sizeof reader->context, "in frame %u, ", frame);
    group_at(group, motion->linear, frame, keys);
    for (int i = 0; i < group->count; i++)
        if (group->tracks[i].count)
            reader_range(reader, &keys[i]);
    if (group == &motion->camera)
        camera_take(reader, errors, keys, place, &camera);
    else
        light_take(reader, errors, motion->light_kind, keys, place, &light);
    reader->context[0] = '\0';
    return reader->errors == errors;
}

static void try_frames(struct reader *reader, const struct motion *motion, struct fy_node *place)
{
    const struct group *groups[] = {&motion->camera, &motion->light};
    for (size_t i = 0; i < DT_ARRAY_COUNT(groups); i++) {
        uint32_t frame = 0;
        while (groups[i]->moves && frame < motion->frames &&
               try_frame(reader, motion, groups[i], frame, place))
            frame++;
    }
}

static void forget_nodes(struct group *group)
{
    for (int i = 0; i < group->count; i++)
        for (uint32_t k = 0; k < group->tracks[i].count; k++)
            group->tracks[i].keys[k].node = NULL;
}

static void read_motion(struct reader *reader, struct fy_node *root, void *user)
{
    enum { INTERPOLATION, RATE, KEYS, COUNT };
    struct key keys[COUNT] = {
        [INTERPOLATION] = {.name = "interpolation", .type = KEY_TEXT},
        [RATE] = KEY_OF_NUMBERS("frames_per_second", false, 1, 0.001, 1000, 1),
        [KEYS] = {.name = "keys", .type = KEY_SEQUENCE, .required = true},
    };
    struct reading *reading = user;
    struct motion *motion = reading->motion;
    struct fy_node_pair *first = fy_node_mapping_get_by_index(root, 0);
    struct fy_node *place = first ? fy_node_pair_key(first) : root;
    int errors = reader->errors;
    reader_mapping(reader, root, place, "the motion", keys, COUNT);
    if (reader->errors > errors)
        return;
    const char *way =
        keys[INTERPOLATION].given ? fy_node_get_scalar0(keys[INTERPOLATION].node) : "catmull_rom";
    motion->linear = strcmp(way, "linear") == 0;
    if (!motion->linear && strcmp(way, "catmull_rom") != 0)
        reader_report(reader, keys[INTERPOLATION].node,
                      "`interpolation` is `catmull_rom` or `linear`");
    reading->frames_per_unit = keys[RATE].number[0];
    motion->frames_per_second = keys[RATE].given ? keys[RATE].number[0] : (double)FRAMES_PER_SECOND;
    reading->last_frame = -1;
    EACH_ITEM(item, keys[KEYS].node)
        read_keyframe(reader, reading, item);
    place = keys[KEYS].name_node;
    if (reader->errors == errors && !motion->camera.moves && !motion->light.moves)
        reader_report(reader, place, "no keyframe moves `camera` or `light`");
    replace_aim(reader, motion, place);
    /* rounding may put seconds times frames per second just above the intended frame */
    motion->frames = (uint32_t)ceil(fmax(reading->last_frame - 1e-6, 0)) + 1;
    if (reader->errors == errors)
        try_frames(reader, motion, place);
    if (reading->out_of_memory)
        reader_report(reader, place, "out of memory");
    forget_nodes(&motion->camera);
    forget_nodes(&motion->light);
}

struct motion *motion_load(const char *path, const struct scene *scene, const struct dt_log *log)
{
    static const struct file_kind motion_file = {
        .name = "motion", .keys = "`keys`, a sequence of keyframes", .read = read_motion};
    struct motion *motion = calloc(1, sizeof *motion);
    if (motion)
        motion->path = strdup(path);
    if (!motion || !motion->path) {
        report_error(log, "%s: out of memory", path);
        motion_free(motion);
        return NULL;
    }
    struct reading reading = {.motion = motion};
    motion->light_kind = scene->light.kind;
    camera_keys(motion->camera.base);
    camera_tell(&scene->camera, motion->camera.base);
    motion->camera.count = CAMERA_KEYS;
    motion->light.count = light_keys(scene->light.kind, motion->light.base) - 1; /* no `kind` */
    light_tell(&scene->light, motion->light.base);
    if (reader_file(path, &motion_file, &reading, log))
        return motion;
    motion_free(motion);
    return NULL;
}

void motion_free(struct motion *motion)
{
    if (!motion)
        return;
    for (int i = 0; i < GROUP_KEYS; i++) {
        free(motion->camera.tracks[i].keys);
        free(motion->light.tracks[i].keys);
    }
    free(motion->path);
    free(motion);
}

uint32_t motion_frames(const struct motion *motion)
{
    return motion->frames;
}

const char *motion_path(const struct motion *motion)
{
    return motion->path;
}
