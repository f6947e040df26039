/* Cameras and lights of a mesh file, for scene files without their own. Called by mesh.c. */
#include "camera_light.h"
#include "mesh.h"

#include <assimp/cimport.h>
#include <assimp/scene.h>
#include <assimp/version.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define LUMENS_PER_WATT 683.0f /* glTF: light is photometric */

struct views {
    bool gltf;
    float scale;
};

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

static void set_place(const struct views *views, const struct aiMatrix4x4 *matrix,
                      struct aiVector3D place, float out[3])
{
    aiTransformVecByMatrix4(&place, matrix);
    memcpy(out, (float[]){place.x * views->scale, place.y * views->scale, place.z * views->scale},
           3 * sizeof *out);
}

/* A unit vector; false if the transform leaves none. */
static bool set_direction(const struct aiMatrix4x4 *matrix, struct aiVector3D direction,
                          float out[3])
{
    struct aiMatrix3x3 turn;
    aiMatrix3FromMatrix4(&turn, matrix);
    aiTransformVecByMatrix3(&direction, &turn);
    float length = hypotf(hypotf(direction.x, direction.y), direction.z);
    memcpy(out, (float[]){direction.x / length, direction.y / length, direction.z / length},
           3 * sizeof *out);
    return length > 1e-12f && isfinite(length);
}

static bool in_range(const struct key *keys, int count)
{
    for (int i = 0; i < count; i++)
        if (keys[i].type == KEY_NUMBERS && !reader_range(NULL, &keys[i]))
            return false;
    return true;
}

/* ---- Cameras --------------------------------------------------------------------------------- */

/* For glTF, assimp up to 5.2 repeats the node's translation as the position, and multiplies angle
 * and aspect where later versions multiply tangents. */
static float vertical_angle(const struct views *views, const struct aiCamera *from)
{
    bool old = aiGetVersionMajor() * 100 + aiGetVersionMinor() <= 502;
    float aspect = from->mAspect > 0 ? from->mAspect : 1;
    return views->gltf && old ? from->mHorizontalFOV / aspect
                              : 2 * atanf(tanf(0.5f * from->mHorizontalFOV) / aspect);
}

/* NULL, or why it cannot be used. */
static const char *take_camera(const struct views *views, const struct aiCamera *from,
                               const struct aiMatrix4x4 *matrix, struct scene_camera *camera)
{
    const struct aiVector3D origin = {0, 0, 0};
    struct key keys[CAMERA_KEYS];
    float view[3];
    if (from->mOrthographicWidth > 0)
        return "it is orthographic";
    bool good =
        set_direction(matrix, from->mLookAt, view) && set_direction(matrix, from->mUp, camera->up);
    set_place(views, matrix, views->gltf ? origin : from->mPosition, camera->eye);
    float along = 0;
    for (int i = 0; i < 3; i++) {
        camera->target[i] = camera->eye[i] + view[i];
        along += view[i] * camera->up[i];
    }
    camera->fov_y = vertical_angle(views, from);
    camera_keys(keys);
    camera_tell(camera, keys);
    return good && fabsf(along) < 0.9999f && in_range(keys, CAMERA_KEYS)
               ? NULL
               : "its numbers are out of range";
}

/* ---- Lights ---------------------------------------------------------------------------------- */

static const char *take_light(const struct views *views, const struct aiLight *from,
                              const struct aiMatrix4x4 *matrix, struct scene_light *light)
{
    const float *color = &from->mColorDiffuse.r;
    struct key keys[LIGHT_KEYS];
    if (from->mType != aiLightSource_SPOT && from->mType != aiLightSource_DIRECTIONAL)
        return "it is neither directional nor a spot";
    light->kind = from->mType == aiLightSource_SPOT ? DT_LIGHT_SPOT : DT_LIGHT_DIRECTIONAL;
    light->cone[0] = from->mAngleInnerCone;
    light->cone[1] = from->mAngleOuterCone;
    bool good = set_direction(matrix, from->mDirection, light->direction) &&
                (light->kind == DT_LIGHT_DIRECTIONAL ||
                 (light->cone[1] > 0.002f && light->cone[0] <= light->cone[1]));
    set_place(views, matrix, from->mPosition, light->position);
    for (int i = 0; i < 3; i++) {
        light->color[i] = views->gltf ? color[i] / LUMENS_PER_WATT : color[i];
        light->opening_min[i] = -(float)FAR;
        light->opening_max[i] = (float)FAR;
    }
    int count = light_keys(light->kind, keys);
    light_tell(light, keys);
    return good && in_range(keys, count) ? NULL
                                         : "its numbers are out of range (a cone has at most 85 "
                                           "degrees to either side)";
}

/* ---- All ------------------------------------------------------------------------------------- */

static bool is_gltf(const char *path)
{
    const char *end = strrchr(path, '.');
    return end && (strcasecmp(end, ".gltf") == 0 || strcasecmp(end, ".glb") == 0);
}

/* Appends the view; there is room. */
static bool add_view(struct mesh *mesh, const struct aiString *name, struct mesh_view view)
{
    view.name = strdup(name->data);
    mesh->views[mesh->view_count++] = view;
    return view.name;
}

bool mesh_views(struct mesh *mesh, const struct aiScene *source, const char *path, float scale)
{
    const struct views views = {is_gltf(path), scale};
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
        view.trouble = take_camera(&views, camera, &matrix, &view.camera);
        good = add_view(mesh, &camera->mName, view);
    }
    for (uint32_t i = 0; good && i < source->mNumLights; i++) {
        const struct aiLight *light = source->mLights[i];
        struct mesh_view view = {.is_light = true};
        if (!find_node(source->mRootNode, &light->mName, &identity, &matrix))
            continue;
        view.trouble = take_light(&views, light, &matrix, &view.light);
        good = add_view(mesh, &light->mName, view);
    }
    return good;
}
