/* The surface that a texel of a paraboloid map shows, from the number of the triangle in the texel.
 * Included by passes that sample the maps. */
#include "../shared/space.glsl"
#include "../shared/facing.glsl"

struct Seen {
    bool surface; /* false: the light left the scene */
    vec3 position, normal, albedo;
};

vec3 corner_position(SceneVertex v)
{
    return vec3(v.px, v.py, v.pz);
}

/* Albedo of the triangle at these barycentric coordinates. `extent`: size of the sampled area,
 * relative to twice the area of the triangle; it selects the mip. */
vec3 albedo_of(SceneVertex a, SceneVertex b, SceneVertex c, vec3 weights, float extent)
{
    SceneMaterial m = scene_materials[a.material];
    vec2 uv = weights.x * vec2(a.u, a.v) + weights.y * vec2(b.u, b.v) + weights.z * vec2(c.u, c.v);
    vec2 e = vec2(b.u - a.u, b.v - a.v);
    vec2 f = vec2(c.u - a.u, c.v - a.v);
    vec2 size = vec2(textureSize(scene_textures, 0).xy);
    float texels = abs(e.x * f.y - e.y * f.x) * size.x * size.y * extent;
    float level = 0.0;
    for (int k = 0; k < 12; k++) {
        level += texels > 2.0 ? 1.0 : 0.0;
        texels *= 0.25;
    }
    vec4 texel = textureLod(scene_textures, vec3(uv, float(max(m.texture_layer, 0))), level);
    return clamp(m.albedo * (m.texture_layer < 0 ? vec3(1.0) : texel.rgb), 0.0, 1.0);
}

/* Corner at a place in paraboloid_indices; places beyond paraboloid_indices continue in scene_indices. */
SceneVertex corner_at(uint place)
{
    uint listed = 3u * uint(paraboloid_listed);
    bool whole = place >= listed;
    uint index = whole ? scene_indices[place - listed] : paraboloid_indices[place];
    return scene_vertices[index];
}

Seen surface_of(ivec3 at)
{
    Seen seen;
    uint number = paraboloid_triangle(at).x;
    seen.surface = number > 0u;
    uint first = 3u * (max(number, 1u) - 1u);
    SceneVertex a = corner_at(first);
    SceneVertex b = corner_at(first + 1u);
    SceneVertex c = corner_at(first + 2u);
    vec2 p = (vec2(at.xy) + 0.5) * (2.0 / float(paraboloid_size)) - 1.0;
    float s = dot(p, p);
    vec3 d = vec3(2.0 * p, 1.0 - s) / (1.0 + s);
    vec3 direction = views[at.z].tangent * d.x + views[at.z].bitangent * d.y +
                     views[at.z].normal * d.z;
    float reach = seen.surface ? paraboloid_distance(at).x : 0.0;
    seen.position = views[at.z].position + direction * reach;

    vec3 e = corner_position(b) - corner_position(a);
    vec3 f = corner_position(c) - corner_position(a);
    vec3 geometric = cross(e, f);
    float twice_area = max(length(geometric), 1e-30);
    vec3 to = seen.position - corner_position(a);
    vec3 unit = geometric / twice_area;
    vec3 weights;
    weights.y = clamp(dot(cross(to, f), unit) / twice_area, 0.0, 1.0);
    weights.z = clamp(dot(cross(e, to), unit) / twice_area, 0.0, 1.0 - weights.y);
    weights.x = 1.0 - weights.y - weights.z;
    vec3 normal = weights.x * vec3(a.nx, a.ny, a.nz) + weights.y * vec3(b.nx, b.ny, b.nz)
        + weights.z * vec3(c.nx, c.ny, c.nz);
    seen.normal = facing_normal(normal, geometric, -direction);
    float omega = 16.0 / (float(paraboloid_size * paraboloid_size) * (1.0 + s) * (1.0 + s));
    float slope = max(abs(dot(unit, direction)), 0.1);
    seen.albedo = albedo_of(a, b, c, weights, omega * reach * reach / (slope * twice_area));
    return seen;
}
