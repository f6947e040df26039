/* Scene files for other programs: the functions of diptych_scene.h, over those of scene.h. */
#include "diptych_scene.h"

#include <stdlib.h>
#include <string.h>

#include "mesh.h"
#include "scene.h"

struct dt_scene_file {
    struct scene scene;
};

struct dt_scene_file *dt_scene_open(const char *path, const char *meshes, const struct dt_log *log)
{
    struct dt_scene_file *file = calloc(1, sizeof *file);
    if (!file) {
        log_message(log, DT_ERROR, "%s: out of memory; free some", path);
        return NULL;
    }
    if (scene_load(&file->scene, path, meshes, log))
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
    return &file->scene.data;
}

void dt_scene_look(struct dt_scene_file *file, const struct dt_scene_camera *camera)
{
    struct scene_camera *own = &file->scene.camera;
    memcpy(own->eye, camera->eye, sizeof own->eye);
    memcpy(own->target, camera->target, sizeof own->target);
    memcpy(own->up, camera->up, sizeof own->up);
    own->fov_y = camera->fov_y;
}

void dt_scene_frame(const struct dt_scene_file *file, uint32_t width, uint32_t height,
                    struct dt_frame *frame)
{
    scene_frame(&file->scene, width, height, frame);
}
