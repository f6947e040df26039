/* The surface that a texel of a view shows, from the number of its triangle. Included by passes that
 * read scene_vertices, scene_indices, scene_materials and scene_textures. */
#include "facing.glsl"
#include "texture.glsl"
#include "triangle.glsl"

struct Surface {
    vec3 hit_position;
    vec3 hit_normal; /* interpolated; not unit */
    vec3 geometric; /* of the triangle; not unit, either side */
    vec3 hit_albedo; /* 0..1 */
};

/* Albedo of a triangle where its corners have these weights. right, up: change of the weights from
 * texel to texel. */
vec3 surface_albedo(Triangle t, vec3 weights, vec3 right, vec3 up)
{
    SceneMaterial m = scene_materials[t.a.material];
    vec2 uv = corner_uv(t.a);
    vec2 e = corner_uv(t.b) - uv;
    vec2 f = corner_uv(t.c) - uv;
    vec3 color =
        texture_trilinear(uv + e * weights.y + f * weights.z, e * right.y + f * right.z,
                          e * up.y + f * up.z, m.texture_layer);
    return clamp(m.albedo * color, 0.0, 1.0);
}

/* `place`: centre of the texel, NDC; `texel`: size of a texel, NDC. */
Surface surface_at(uint number, vec2 place, vec2 texel, mat4 view_projection)
{
    Triangle t = triangle_of(number);
    vec3 origin = corner_position(t.a);
    vec4 a = transform_point(view_projection, origin);
    vec4 b = transform_point(view_projection, corner_position(t.b));
    vec4 c = transform_point(view_projection, corner_position(t.c));
    vec3 w = vec3(a.w, b.w, c.w);
    vec3 x = vec3(a.x, b.x, c.x) - place.x * w;
    vec3 y = vec3(a.y, b.y, c.y) - place.y * w;
    vec3 areas = ray_areas(x, y);
    float sum = areas.x + areas.y + areas.z;
    float scale = sum == 0.0 ? 0.0 : approximate_reciprocal(sum);
    vec3 weights = areas * scale;
    vec3 right = ray_areas(y, w); /* change of the areas with place.x */
    vec3 up = ray_areas(w, x);
    right = (right - weights * (right.x + right.y + right.z)) * (scale * texel.x);
    up = (up - weights * (up.x + up.y + up.z)) * (scale * texel.y);
    weights = within_triangle(weights);

    Surface s;
    vec3 e = corner_position(t.b) - origin;
    vec3 f = corner_position(t.c) - origin;
    s.hit_position = origin + e * weights.y + f * weights.z;
    s.geometric = cross(e, f);
    s.hit_normal = corner_normal(t.a) * weights.x + corner_normal(t.b) * weights.y +
               corner_normal(t.c) * weights.z;
    s.hit_albedo = surface_albedo(t, weights, right, up);
    return s;
}
