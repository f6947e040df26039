/* Cameras and lights of a glTF file; see gltf.h. */
#include "camera_light.h"
#include "gltf.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LUMENS_PER_WATT 683.0f /* light is photometric: lm/sr and lx */

/* A point or a direction of the node in the scene's axes. */
static void transform(const double m[4][4], const double v[4], float out[3])
{
    for (int r = 0; r < 3; r++)
        out[r] = (float)(m[0][r] * v[0] + m[1][r] * v[1] + m[2][r] * v[2] + m[3][r] * v[3]);
}

static struct mesh_view view_at(const double matrix[4][4], float scale)
{
    static const double origin[4] = {0, 0, 0, 1}, ahead[4] = {0, 0, -1, 0}, up[4] = {0, 1, 0, 0};
    struct mesh_view view = {0};
    float place[3];
    transform(matrix, origin, place);
    for (int i = 0; i < 3; i++)
        view.camera.eye[i] = view.light.position[i] = place[i] * scale;
    transform(matrix, ahead, view.light.direction);
    transform(matrix, up, view.camera.up);
    return view;
}

/* ---- Checks ---------------------------------------------------------------------------------- */

/* The checks make directions unit vectors and check ranges; a camera's `target` is the direction that it looks in, until
 * then. They set `trouble` if it cannot be used. */

/* Makes a unit vector; false if it has no direction. */
static bool make_unit(float v[3])
{
    float length = hypotf(hypotf(v[0], v[1]), v[2]);
    for (int i = 0; i < 3; i++)
        v[i] /= length;
    return length > 1e-12f && isfinite(length);
}

static bool in_range(const struct key *keys, int count)
{
    for (int i = 0; i < count; i++)
        if (keys[i].type == KEY_NUMBERS && !reader_range(NULL, &keys[i]))
            return false;
    return true;
}

static void check_camera(struct mesh_view *view)
{
    struct dt_scene_camera *camera = &view->camera;
    struct key keys[CAMERA_KEYS];
    float along = 0;
    bool good = make_unit(camera->target), upright = make_unit(camera->up);
    for (int i = 0; i < 3; i++) {
        along += camera->target[i] * camera->up[i];
        camera->target[i] += camera->eye[i];
    }
    camera_keys(keys);
    camera_tell(camera, keys);
    if (!good || !upright || !(fabsf(along) < 0.9999f) || !in_range(keys, CAMERA_KEYS))
        view->trouble = "its numbers are out of range";
}

static void check_light(struct mesh_view *view)
{
    struct scene_light *light = &view->light;
    struct key keys[LIGHT_KEYS];
    int count = light_keys(light->kind, keys);
    bool good = make_unit(light->direction) &&
                (light->kind == DT_LIGHT_DIRECTIONAL ||
                 (light->cone[1] > 0.002f && light->cone[0] <= light->cone[1]));
    for (int i = 0; i < 3; i++) {
        light->opening_min[i] = -(float)FAR;
        light->opening_max[i] = (float)FAR;
    }
    light_tell(light, keys);
    if (!good || !in_range(keys, count))
        view->trouble = "its numbers are out of range (a cone has at most 85 degrees to either "
                        "side)";
}

/* ---- Cameras and lights ---------------------------------------------------------------------- */

static void take_camera(struct gltf *gltf, struct gltf_item camera, struct mesh_view *view)
{
    struct gltf_item perspective = gltf_part(gltf, camera, "perspective");
    memcpy(view->camera.target, view->light.direction, sizeof view->camera.target);
    view->camera.fov_y = gltf_number(gltf, perspective, "yfov", 0);
    if (strcmp(gltf_text(camera, "type", ""), "orthographic") == 0)
        view->trouble = "it is orthographic";
    else
        check_camera(view);
}

static void take_light(struct gltf *gltf, struct gltf_item light, struct mesh_view *view)
{
    const char *type = gltf_text(light, "type", "");
    struct gltf_item spot = gltf_part(gltf, light, "spot");
    float color[3] = {1, 1, 1}, intensity = gltf_number(gltf, light, "intensity", 1);
    gltf_numbers(gltf, light, "color", 3, color);
    view->is_light = true;
    view->light.kind = strcmp(type, "spot") == 0 ? DT_LIGHT_SPOT : DT_LIGHT_DIRECTIONAL;
    view->light.cone[0] = gltf_number(gltf, spot, "innerConeAngle", 0);
    view->light.cone[1] = gltf_number(gltf, spot, "outerConeAngle", (float)M_PI_4);
    for (int i = 0; i < 3; i++)
        view->light.color[i] = color[i] * intensity / LUMENS_PER_WATT;
    if (view->light.kind == DT_LIGHT_SPOT || strcmp(type, "directional") == 0)
        check_light(view);
    else
        view->trouble = "it is neither directional nor a spot";
}

/* Appends the view of node `index`; there is room. */
static void add_view(struct gltf *gltf, struct mesh *mesh, uint32_t index, struct gltf_item from,
                     float scale)
{
    struct gltf_item node = gltf_item(gltf, GLTF_NODES, index);
    struct mesh_view view = view_at(gltf_object(gltf, node)->matrix, scale);
    if (from.kind == GLTF_CAMERAS)
        take_camera(gltf, from, &view);
    else
        take_light(gltf, from, &view);
    view.name = strdup(gltf_text(node, "name", gltf_text(from, "name", "")));
    if (!view.name)
        gltf_out_of_memory(gltf);
    mesh->views[mesh->view_count++] = view;
}

bool gltf_views(struct gltf *gltf, struct mesh *mesh, float scale)
{
    uint32_t nodes = gltf->list[GLTF_NODES].count;
    mesh->views = calloc(2 * (size_t)nodes + 1, sizeof *mesh->views);
    if (!mesh->views)
        return gltf_out_of_memory(gltf);
    for (uint32_t i = 0; i < nodes && !gltf->failed; i++) {
        struct gltf_item node = gltf_item(gltf, GLTF_NODES, i);
        struct gltf_item lamp = gltf_extension(gltf, node, "KHR_lights_punctual");
        int32_t camera = gltf_index(gltf, node, "camera", GLTF_CAMERAS);
        int32_t light = gltf_index(gltf, lamp, "light", GLTF_LIGHTS);
        if (gltf_object(gltf, node)->matrix[3][3] == 0)
            continue; /* not in the scene */
        if (camera >= 0)
            add_view(gltf, mesh, i, gltf_item(gltf, GLTF_CAMERAS, (uint32_t)camera), scale);
        if (light >= 0)
            add_view(gltf, mesh, i, gltf_item(gltf, GLTF_LIGHTS, (uint32_t)light), scale);
    }
    return !gltf->failed;
}
