/* Scenes for other programs: the functions of diptych_scene.h, over those of scene.h. */
#include "diptych_scene.h"

#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "scene.h"
#include "base/log.h"

struct dt_scene_file {
    struct scene scene;
};

struct dt_scene_file *dt_scene_open(const char *path, const char *meshes, const struct dt_log *log)
{
    const struct dt_log none = {0};
    struct dt_scene_file *file = path ? calloc(1, sizeof *file) : NULL;
    log = log ? log : &none;
    if (!file) {
        report_error(log, "%s", path ? "out of memory; free some" : "the path of a scene is NULL");
        return NULL;
    }
    locale_t point = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0);
    locale_t before = point ? uselocale(point) : (locale_t)0; /* of this thread alone */
    bool good = scene_load(&file->scene, path, meshes, false, log);
    if (point) {
        uselocale(before);
        freelocale(point);
    }
    if (good)
        return file;
    free(file);
    return NULL;
}

void dt_scene_close(struct dt_scene_file *file)
{
    if (file)
        scene_free(&file->scene);
    free(file);
}

const struct dt_scene *dt_scene_data(const struct dt_scene_file *file)
{
    return file ? &file->scene.data : NULL;
}

void dt_scene_look(struct dt_scene_file *file, const struct dt_scene_camera *camera)
{
    if (file && camera)
        file->scene.camera = *camera;
}

static void set_light(struct scene *scene, const struct dt_scene_light *light)
{
    struct scene_light *own = &scene->light;
    bool opening = false;
    own->kind = light->kind;
    memcpy(own->position, light->position, sizeof own->position);
    memcpy(own->direction, light->direction, sizeof own->direction);
    memcpy(own->cone, light->cone, sizeof own->cone);
    memcpy(own->color, light->color, sizeof own->color);
    for (int i = 0; i < 3; i++)
        opening = opening || light->opening_min[i] != 0 || light->opening_max[i] != 0;
    for (int i = 0; i < 3; i++) {
        own->opening_min[i] = opening ? light->opening_min[i] : -INFINITY;
        own->opening_max[i] = opening ? light->opening_max[i] : INFINITY;
    }
}

void dt_scene_compose(const struct dt_scene_camera *camera, const struct dt_scene_light *light,
                      const struct dt_scene_extent *extent, uint32_t width, uint32_t height,
                      struct dt_frame *frame)
{
    if (frame)
        *frame = (struct dt_frame){0};
    if (!frame || !camera || !light || !extent)
        return;
    struct scene scene = {.camera = *camera,
                          .radius = extent->radius,
                          .data = {.index_count = 3 * extent->triangle_count}};
    set_light(&scene, light);
    for (int i = 0; i < 3; i++) {
        scene.bounds_min[i] = extent->low[i];
        scene.bounds_max[i] = extent->high[i];
        scene.center[i] = 0.5f * extent->low[i] + 0.5f * extent->high[i];
    }
    scene_frame(&scene, width, height, frame);
}

void dt_scene_frame(const struct dt_scene_file *file, uint32_t width, uint32_t height,
                    struct dt_frame *frame)
{
    if (frame && file)
        scene_frame(&file->scene, width, height, frame);
    else if (frame)
        *frame = (struct dt_frame){0};
}
