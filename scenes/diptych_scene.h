/* Scene files of diptych for other programs: a mesh, materials and textures as plain arrays, and the
 * block that every frame of a pipeline gets. No graphics API; see diptych_vk.h and diptych_gl.h for where
 * the arrays go. A renderer with scenes of its own fills struct dt_scene's counterparts and struct
 * dt_frame itself. No global state; a scene belongs to one thread at a time. */
#ifndef DIPTYCH_SCENE_FILE_H
#define DIPTYCH_SCENE_FILE_H

#include "diptych.h"

#ifdef __cplusplus
extern "C" {
#endif

#pragma GCC visibility push(default) /* what the libraries export */

struct dt_scene_file;

/* Reads a scene file (YAML) and its mesh, which is looked up beside it, then below `meshes` (may be
 * NULL). NULL: the log has said why, with file:line:col. */
struct dt_scene_file *dt_scene_open(const char *path, const char *meshes, const struct dt_log *log);
void dt_scene_close(struct dt_scene_file *file); /* takes NULL */

/* The arrays, until close. */
const struct dt_scene *dt_scene_data(const struct dt_scene_file *file);

/* Moves the camera; lengths in the scene's unit, fov_y in radians, the whole angle. */
struct dt_scene_camera {
    float eye[3], target[3], up[3];
    float fov_y;
};
void dt_scene_look(struct dt_scene_file *file, const struct dt_scene_camera *camera);

/* Camera and light as passes see them, for a frame of that size in pixels. All of *frame is written;
 * `index` is 0. */
void dt_scene_frame(const struct dt_scene_file *file, uint32_t width, uint32_t height,
                    struct dt_frame *frame);

#pragma GCC visibility pop

#ifdef __cplusplus
}
#endif
#endif
