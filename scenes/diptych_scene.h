/* Scenes for other programs: computes the frame block of a pipeline from camera, light and bounds;
 * reads diptych's scene files into plain arrays. No graphics API: pass the arrays to diptych_vk.h
 * or diptych_gl.h. No global state; one thread at a time may use a scene.
 *
 * Lengths are in the scene's unit, angles in radians. Vectors are right-handed; triangles are seen
 * from the front when their vertices run counter-clockwise. */
#ifndef DIPTYCH_SCENE_FILE_H
#define DIPTYCH_SCENE_FILE_H

#include "diptych.h"

#ifdef __cplusplus
extern "C" {
#endif

#pragma GCC visibility push(default) /* what the libraries export */

/* ---- For renderers with their own scenes ----------------------------------------------------- */

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
    /* directional: box that all light passes through, such as a hole in a roof; all samples pass
     * through it; all zero: no box */
    float opening_min[3], opening_max[3];
};

/* Bounds of the scene. */
struct dt_scene_extent {
    float low[3], high[3]; /* box of all vertices */
    float radius;          /* of a sphere about the middle of the box that holds all of them */
    uint32_t triangle_count;
};

/* Computes the frame block for a frame size in pixels: near and far planes around the scene, a
 * light view that covers all lit parts. Writes all of *frame; the caller sets index and time. */
void dt_scene_compose(const struct dt_scene_camera *camera, const struct dt_scene_light *light,
                      const struct dt_scene_extent *extent, uint32_t width, uint32_t height,
                      struct dt_frame *frame);

/* Makes the first corner of each triangle the first of no other, as vertex_triangle needs: turns the
 * corners, which keeps the winding, and adds copies of vertices. `triangles`: gets the `triangle` of
 * struct dt_vertex for each vertex. `copied`: gets the vertex of which vertex_count + k is a copy.
 * They have room for vertex_count + index_count / 3 and index_count / 3 elements; both are less than
 * 2^32. Returns the new number of vertices. */
uint32_t dt_number_triangles(uint32_t *indices, uint32_t index_count, uint32_t vertex_count,
                             uint32_t *triangles, uint32_t *copied);

/* ---- Scene files ----------------------------------------------------------------------------- */

struct dt_scene_file;

/* Reads a scene file (YAML) and its mesh. The mesh is searched beside the scene file, then below
 * `meshes` (may be NULL). NULL after an error, logged with file:line:col. Numbers have a decimal
 * point in any locale. libdiptych_image.so in lib/diptych reads textures. The shared library finds
 * it relative to itself; a static program by its run path (pkg-config --static). If it is missing,
 * textures are omitted with a DT_WARNING. */
struct dt_scene_file *dt_scene_open(const char *path, const char *meshes, const struct dt_log *log);
void dt_scene_close(struct dt_scene_file *file); /* takes NULL */

/* The arrays; valid until close. */
const struct dt_scene *dt_scene_data(const struct dt_scene_file *file);

/* Moves the camera. */
void dt_scene_look(struct dt_scene_file *file, const struct dt_scene_camera *camera);

/* As dt_scene_compose, for this scene. */
void dt_scene_frame(const struct dt_scene_file *file, uint32_t width, uint32_t height,
                    struct dt_frame *frame);

#pragma GCC visibility pop

#ifdef __cplusplus
}
#endif
#endif
