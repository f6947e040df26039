/* The surface that a texel of a map shows, from the number of the triangle in the texel. Included by
 * passes that sample the maps. */
#include "../shared/space.glsl"
#include "../shared/facing.glsl"
#include "../shared/texture.glsl"
#include "../shared/triangle.glsl"
#include "map.glsl"

struct Seen {
    bool surface; /* false: the light left the scene */
    vec3 position, normal, albedo;
};

/* Albedo of the triangle at these barycentric coordinates. `extent`: size of the sampled area,
 * relative to twice the area of the triangle; it selects the mip. */
vec3 albedo_of(Triangle t, vec3 weights, float extent)
{
    SceneMaterial m = scene_materials[t.a.material];
    vec2 e = corner_uv(t.b) - corner_uv(t.a);
    vec2 f = corner_uv(t.c) - corner_uv(t.a);
    vec2 uv = corner_uv(t.a) + e * weights.y + f * weights.z;
    vec2 size = vec2(textureSize(scene_textures, 0).xy);
    float texels = abs(e.x * f.y - e.y * f.x) * size.x * size.y * extent;
    int level = 0;
    for (int k = 1; k < textureQueryLevels(scene_textures); k++) {
        level += texels > 2.0 ? 1 : 0;
        texels *= 0.25;
    }
    vec3 color = texture_linear(uv - floor(uv), m.texture_layer, level, 0.0);
    return clamp(m.albedo * color, 0.0, 1.0);
}

Seen surface_of(ivec3 at)
{
    Seen seen;
    uint found = min(number(at).x, frame.triangle_count); /* of this scene */
    seen.surface = found > 0u;
    Triangle t = triangle_of(max(found, 1u) - 1u);
    vec3 ray = texel_ray(vec2(at.xy) + 0.5);
    vec3 along = eyes[at.z].tangent * ray.x + eyes[at.z].bitangent * ray.y +
                 eyes[at.z].normal * ray.z;
    float far = seen.surface ? reach(at).x : 0.0;
    seen.position = eyes[at.z].position + along * far;

    vec3 e = corner_position(t.b) - corner_position(t.a);
    vec3 f = corner_position(t.c) - corner_position(t.a);
    vec3 geometric = cross(e, f);
    float twice_area = max(length(geometric), 1e-30);
    vec3 to = seen.position - corner_position(t.a);
    vec3 unit = geometric / twice_area;
    vec3 weights = within_triangle(
        vec3(0.0, dot(cross(to, f), unit), dot(cross(e, to), unit)) / twice_area);
    vec3 normal = corner_normal(t.a) * weights.x + corner_normal(t.b) * weights.y +
                  corner_normal(t.c) * weights.z;
    seen.normal = facing_normal(normal, geometric, -along);
    /* Area of the surface in the texel. Of a square of side 2 at reach 1, seen along a ray:
     * dw = dA / (SLANT ray^3). */
    float texel = 4.0 / float(map_size * map_size);
    float slope = max(abs(dot(unit, along)), 0.1 * length(ray));
    seen.albedo = albedo_of(t, weights, texel * far * far / (SLANT * slope * twice_area));
    return seen;
}
