/* Cameras and lights of a mesh file, for scene files without their own. */
#include "camera_light.h"
#include "mesh.h"

#include <assimp/cimport.h>
#include <assimp/scene.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Places ---------------------------------------------------------------------------------- */

/* The node's transform to the scene; false: no node has this name. */
static bool find_node(const struct aiNode *node, const struct aiString *name,
                      const struct aiMatrix4x4 *parent, struct aiMatrix4x4 *matrix)
{
    struct aiMatrix4x4 own = *parent;
    aiMultiplyMatrix4(&own, &node->mTransformation);
    bool found = strcmp(node->mName.data, name->data) == 0;
    if (found)
        *matrix = own;
    for (uint32_t i = 0; i < node->mNumChildren && !found; i++)
        found = find_node(node->mChildren[i], name, &own, matrix);
    return found;
}

static void set_place(float scale, const struct aiMatrix4x4 *matrix, struct aiVector3D place,
                      float out[3])
{
    aiTransformVecByMatrix4(&place, matrix);
    memcpy(out, (float[]){place.x * scale, place.y * scale, place.z * scale}, 3 * sizeof *out);
}

static void set_direction(const struct aiMatrix4x4 *matrix, struct aiVector3D direction,
                          float out[3])
{
    struct aiMatrix3x3 turn;
    aiMatrix3FromMatrix4(&turn, matrix);
    aiTransformVecByMatrix3(&direction, &turn);
    memcpy(out, &direction, 3 * sizeof *out);
}

/* ---- Checks ---------------------------------------------------------------------------------- */

/* Makes a unit vector; false if it has no direction. */
static bool normalize(float v[3])
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

void mesh_check_camera(struct mesh_view *view)
{
    struct scene_camera *camera = &view->camera;
    struct key keys[CAMERA_KEYS];
    float along = 0;
    bool good = normalize(camera->target), upright = normalize(camera->up);
    for (int i = 0; i < 3; i++) {
        along += camera->target[i] * camera->up[i];
        camera->target[i] += camera->eye[i];
    }
    camera_keys(keys);
    camera_tell(camera, keys);
    if (!good || !upright || !(fabsf(along) < 0.9999f) || !in_range(keys, CAMERA_KEYS))
        view->trouble = "its numbers are out of range";
}

void mesh_check_light(struct mesh_view *view)
{
    struct scene_light *light = &view->light;
    struct key keys[LIGHT_KEYS];
    int count = light_keys(light->kind, keys);
    bool good = normalize(light->direction) &&
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

static void take_camera(struct mesh_view *view, const struct aiCamera *from,
                        const struct aiMatrix4x4 *matrix, float scale)
{
    float aspect = from->mAspect > 0 ? from->mAspect : 1;
    set_direction(matrix, from->mLookAt, view->camera.target);
    set_direction(matrix, from->mUp, view->camera.up);
    set_place(scale, matrix, from->mPosition, view->camera.eye);
    view->camera.fov_y = 2 * atanf(tanf(0.5f * from->mHorizontalFOV) / aspect);
    if (from->mOrthographicWidth > 0)
        view->trouble = "it is orthographic";
    else
        mesh_check_camera(view);
}

static void take_light(struct mesh_view *view, const struct aiLight *from,
                       const struct aiMatrix4x4 *matrix, float scale)
{
    struct scene_light *light = &view->light;
    light->kind = from->mType == aiLightSource_SPOT ? DT_LIGHT_SPOT : DT_LIGHT_DIRECTIONAL;
    light->cone[0] = from->mAngleInnerCone;
    light->cone[1] = from->mAngleOuterCone;
    memcpy(light->color, &from->mColorDiffuse, sizeof light->color);
    set_direction(matrix, from->mDirection, light->direction);
    set_place(scale, matrix, from->mPosition, light->position);
    if (from->mType != aiLightSource_SPOT && from->mType != aiLightSource_DIRECTIONAL)
        view->trouble = "it is neither directional nor a spot";
    else
        mesh_check_light(view);
}

/* ---- All ------------------------------------------------------------------------------------- */

/* Appends the view; there is room. */
static bool add_view(struct mesh *mesh, const struct aiString *name, struct mesh_view view)
{
    view.name = strdup(name->data);
    mesh->views[mesh->view_count++] = view;
    return view.name;
}

bool mesh_views(struct mesh *mesh, const struct aiScene *source, float scale)
{
    struct aiMatrix4x4 identity, matrix;
    aiIdentityMatrix4(&identity);
    mesh->views = calloc(source->mNumCameras + source->mNumLights + 1, sizeof *mesh->views);
    bool good = mesh->views;
    /* no node: not in the scene */
    for (uint32_t i = 0; good && i < source->mNumCameras; i++) {
        const struct aiCamera *camera = source->mCameras[i];
        struct mesh_view view = {.is_light = false};
        if (!find_node(source->mRootNode, &camera->mName, &identity, &matrix))
            continue;
        take_camera(&view, camera, &matrix, scale);
        good = add_view(mesh, &camera->mName, view);
    }
    for (uint32_t i = 0; good && i < source->mNumLights; i++) {
        const struct aiLight *light = source->mLights[i];
        struct mesh_view view = {.is_light = true};
        if (!find_node(source->mRootNode, &light->mName, &identity, &matrix))
            continue;
        take_light(&view, light, &matrix, scale);
        good = add_view(mesh, &light->mName, view);
    }
    return good;
}
