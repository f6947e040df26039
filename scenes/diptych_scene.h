/* Scenes for other programs: the block that every frame of a pipeline gets, from a camera, a light and
 * what they look at; and diptych's scene files, a mesh, materials and textures as plain arrays. No
 * graphics API; see diptych_vk.h and diptych_gl.h for where the arrays go. No global state; a scene
 * belongs to one thread at a time.
 *
 * Lengths are in the scene's unit, angles in radians. Vectors are right-handed; triangles are seen from
 * the front when their vertices run counter-clockwise. */
#ifndef DIPTYCH_SCENE_FILE_H
#define DIPTYCH_SCENE_FILE_H

#include "diptych.h"

#ifdef __cplusplus
extern "C" {
#endif

#pragma GCC visibility push(default) /* what the libraries export */

/* ---- Of a renderer with scenes of its own ----------------------------------------------------- */

struct dt_scene_camera {
    float eye[3], target[3], up[3]; /* up: unit, or nearly; not along the view */
    float fov_y;                    /* the whole angle */
};

struct dt_scene_light {
    int kind;           /* DT_LIGHT_DIRECTIONAL or DT_LIGHT_SPOT */
    float position[3];  /* spot */
    float direction[3]; /* unit, the way that light travels */
    float cone[2];      /* spot: inner and outer half angle */
    float color[3];     /* directional: irradiance, W/m2; spot: intensity on the axis, W/sr */
    /* directional: a box that all of its light passes through, as a hole in a roof, so that no sample
     * is spent outside; all zero: there is none */
    float opening_min[3], opening_max[3];
};

/* What camera and light look at. */
struct dt_scene_extent {
    float low[3], high[3]; /* box of all vertices */
    float radius;          /* of a sphere about the middle of the box that holds all of them */
    uint32_t triangle_count;
};

/* Camera and light as passes see them, for a frame of that size in pixels: near and far planes about the
 * scene, a view of the light that covers all it can reach. All of *frame is written; `index` is 0. */
void dt_scene_compose(const struct dt_scene_camera *camera, const struct dt_scene_light *light,
                      const struct dt_scene_extent *extent, uint32_t width, uint32_t height,
                      struct dt_frame *frame);

/* ---- Scene files ------------------------------------------------------------------------------ */

struct dt_scene_file;

/* Reads a scene file (YAML) and its mesh, which is looked up beside it, then below `meshes` (may be
 * NULL). NULL: the log has said why, with file:line:col. Numbers have a point whatever the locale.
 * Textures are read by libdiptych_image.so in lib/diptych: the shared library finds it from its own
 * place, a program with the static one by its run path, which pkg-config --static gives; else they are
 * left out with a DT_WARNING. */
struct dt_scene_file *dt_scene_open(const char *path, const char *meshes, const struct dt_log *log);
void dt_scene_close(struct dt_scene_file *file); /* takes NULL */

/* The arrays, until close. */
const struct dt_scene *dt_scene_data(const struct dt_scene_file *file);

/* Moves the camera. */
void dt_scene_look(struct dt_scene_file *file, const struct dt_scene_camera *camera);

/* As dt_scene_compose has it. */
void dt_scene_frame(const struct dt_scene_file *file, uint32_t width, uint32_t height,
                    struct dt_frame *frame);

#pragma GCC visibility pop

#ifdef __cplusplus
}
#endif
#endif
