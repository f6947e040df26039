/* Camera and light matrices of a scene: everything in struct dt_frame that depends on the scene
 * and the aspect ratio. Right-handed, clip space with y up and depth 0..1. */
#include "mesh.h"
#include "scene.h"

#define CGLM_FORCE_DEPTH_ZERO_TO_ONE
#include <cglm/cglm.h>

#include <math.h>
#include <string.h>

/* Up is y, or z if the direction is nearly vertical. */
static void up_for(const float direction[3], vec3 up)
{
    bool vertical = fabsf(direction[1]) > 0.99f;
    glm_vec3_copy(vertical ? (vec3){0, 0, 1} : (vec3){0, 1, 0}, up);
}

/* Corner k of a box: bit i of k selects the end of axis i. */
static void corner_of(const float low[3], const float high[3], int k, vec3 corner)
{
    for (int i = 0; i < 3; i++)
        corner[i] = k >> i & 1 ? high[i] : low[i];
}

/* Bounding box of a box in view space, where the camera looks along -z. */
static void view_bounds(const float low[3], const float high[3], mat4 view, vec3 box[2])
{
    glm_vec3_broadcast(INFINITY, box[0]);
    glm_vec3_broadcast(-INFINITY, box[1]);
    for (int k = 0; k < 8; k++) {
        vec3 corner;
        corner_of(low, high, k, corner);
        glm_mat4_mulv3(view, corner, 1, corner);
        glm_vec3_minv(box[0], corner, box[0]);
        glm_vec3_maxv(box[1], corner, box[1]);
    }
}

/* Near and far planes around the scene. For a viewer inside it the near plane is at 1/200 of the
 * radius. */
static void depth_range(const struct scene *scene, vec3 box[2], float *near, float *far)
{
    *near = fmaxf(scene->radius * 0.005f, -box[1][2] * 0.999f);
    *far = fmaxf(-box[0][2] * 1.001f, *near * 2);
}

/* Gauss-Jordan with pivots. */
void invert(const double m[4][4], float out[4][4])
{
    double a[4][8] = {{0}};
    for (int row = 0; row < 4; row++) {
        for (int column = 0; column < 4; column++)
            a[row][column] = m[column][row];
        a[row][4 + row] = 1;
    }
    for (int k = 0; k < 4; k++) {
        int pivot = k;
        for (int row = k + 1; row < 4; row++)
            if (fabs(a[row][k]) > fabs(a[pivot][k]))
                pivot = row;
        for (int column = 0; column < 8; column++) {
            double swap = a[k][column];
            a[k][column] = a[pivot][column];
            a[pivot][column] = swap;
        }
        double scale = 1 / a[k][k];
        for (int column = 0; column < 8; column++)
            a[k][column] *= scale;
        for (int row = 0; row < 4; row++) {
            double factor = a[row][k];
            for (int column = 0; row != k && column < 8; column++)
                a[row][column] -= factor * a[k][column];
        }
    }
    for (int row = 0; row < 4; row++)
        for (int column = 0; column < 4; column++)
            out[column][row] = (float)a[row][4 + column];
}

/* Computes product and inverse from the same float matrices that shaders use. */
static void complete_view(struct dt_view *out, mat4 view, mat4 projection)
{
    double product[4][4];
    for (int column = 0; column < 4; column++)
        for (int row = 0; row < 4; row++) {
            product[column][row] = 0;
            for (int k = 0; k < 4; k++)
                product[column][row] += (double)projection[k][row] * view[column][k];
            out->view_projection[column][row] = (float)product[column][row];
        }
    invert(product, out->inverse_view_projection);
    memcpy(out->view, view, sizeof out->view);
    memcpy(out->projection, projection, sizeof out->projection);
}

static void camera_view(const struct scene *scene, float aspect, struct dt_view *out)
{
    vec3 eye, target, up, box[2];
    mat4 view, projection;
    memcpy(eye, scene->camera.eye, sizeof eye);
    memcpy(target, scene->camera.target, sizeof target);
    memcpy(up, scene->camera.up, sizeof up);
    glm_lookat_rh(eye, target, up, view);
    view_bounds(scene->bounds_min, scene->bounds_max, view, box);
    depth_range(scene, box, &out->near_plane, &out->far_plane);
    glm_perspective_rh_zo(scene->camera.fov_y, aspect, out->near_plane, out->far_plane, projection);
    complete_view(out, view, projection);
    glm_vec3_copy(eye, out->position);
    glm_vec3_sub(target, eye, out->direction);
    glm_vec3_normalize(out->direction);
}

/* Up is the longest side of the scene that is not along the light: the map is then aligned with the
 * walls, and little of it is empty. */
static void up_along_walls(const struct scene *scene, const float direction[3], vec3 up)
{
    int best = -1;
    for (int i = 0; i < 3; i++) {
        float side = scene->bounds_max[i] - scene->bounds_min[i];
        if (fabsf(direction[i]) < 0.8f &&
            (best < 0 || side > scene->bounds_max[best] - scene->bounds_min[best]))
            best = i;
    }
    glm_vec3_zero(up);
    up[best < 0 ? 1 : best] = 1; /* of a unit vector, at most one component is 0.8 or more */
}

/* Fits an orthographic view around the points that light reaches through the opening. Returns its
 * area. */
static float directional_view(const struct scene *scene, struct dt_view *out)
{
    const struct scene_light *light = &scene->light;
    vec3 eye, target, up, direction, box[2], opening[2];
    float low[3], high[3];
    mat4 view, projection;
    memcpy(direction, scene->light.direction, sizeof direction);
    memcpy(target, scene->center, sizeof target);
    glm_vec3_scale(direction, -2 * scene->radius, eye);
    glm_vec3_add(target, eye, eye);
    up_along_walls(scene, direction, up);
    glm_lookat_rh(eye, target, up, view);
    view_bounds(scene->bounds_min, scene->bounds_max, view, box);
    for (int i = 0; i < 3; i++) {
        low[i] = fmaxf(light->opening_min[i], scene->bounds_min[i]);
        high[i] = fminf(light->opening_max[i], scene->bounds_max[i]);
    }
    view_bounds(low, high, view, opening);
    /* Half a per cent of room keeps what lies in the box's sides inside the map; the area counts
     * it too. */
    float margin = scene->radius * 0.005f;
    float left = opening[0][0] - margin, right = opening[1][0] + margin;
    float bottom = opening[0][1] - margin, top = opening[1][1] + margin;
    out->near_plane = -box[1][2] - margin;
    out->far_plane = -box[0][2] + margin;
    glm_ortho_rh_zo(left, right, bottom, top, out->near_plane, out->far_plane, projection);
    complete_view(out, view, projection);
    glm_vec3_copy(eye, out->position);
    glm_vec3_copy(direction, out->direction);
    return (right - left) * (top - bottom);
}

/* Perspective, square, just as wide as the cone. Returns the area of its image plane at distance
 * 1. */
static float spot_view(const struct scene *scene, struct dt_view *out)
{
    vec3 eye, up, direction, box[2];
    mat4 view, projection;
    memcpy(eye, scene->light.position, sizeof eye);
    memcpy(direction, scene->light.direction, sizeof direction);
    up_for(direction, up);
    glm_look_rh(eye, direction, up, view);
    view_bounds(scene->bounds_min, scene->bounds_max, view, box);
    depth_range(scene, box, &out->near_plane, &out->far_plane);
    glm_perspective_rh_zo(2 * scene->light.cone[1], 1, out->near_plane, out->far_plane, projection);
    complete_view(out, view, projection);
    glm_vec3_copy(eye, out->position);
    glm_vec3_copy(direction, out->direction);
    float side = 2 * tanf(scene->light.cone[1]);
    return side * side;
}

void scene_frame(const struct scene *scene, uint32_t width, uint32_t height, struct dt_frame *frame)
{
    *frame = (struct dt_frame){.scene_radius = scene->radius,
                               .triangle_count = scene->data.index_count / 3};
    memcpy(frame->scene_center, scene->center, sizeof frame->scene_center);
    camera_view(scene, (float)width / (float)height, &frame->camera);
    struct dt_light *light = &frame->light;
    light->kind = scene->light.kind;
    memcpy(light->position, scene->light.position, sizeof light->position);
    memcpy(light->direction, scene->light.direction, sizeof light->direction);
    memcpy(light->color, scene->light.color, sizeof light->color);
    light->cos_inner = cosf(scene->light.cone[0]);
    light->cos_outer = cosf(scene->light.cone[1]);
    light->area = light->kind == DT_LIGHT_SPOT ? spot_view(scene, &frame->light_view)
                                               : directional_view(scene, &frame->light_view);
}
