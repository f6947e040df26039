/* Paraboloid maps (Heidrich, Seidel 1998), all clusters in one layered draw. Includers say from where:
 * MAP_SIZE, texels per side; map_eye(c), map_tangent(c), map_bitangent(c), map_axis(c) and
 * map_member(c), of struct ClusterView; and their fragment part defines write_texel(point, reach,
 * normal, albedo), what a texel keeps.
 *
 * The projection is uv = d.xy / (1 + d.z)
 * for the unit direction d in the cluster's frame, written with the homogeneous coordinate |d| +
 * d.z so that clipping at the horizon and the interpolation of positions stay linear in space.
 *
 * Triangles are still bent, since only their corners are projected. The texel's own direction is
 * therefore cut with the plane of the triangle: where neighbours share a plane the stored position
 * and distance are those of an exact map, however coarse the triangles. */
#include "../shared/space.glsl"

#ifdef VERTEX
layout(location = 0) out vec3 position;
layout(location = 1) out vec3 normal;
layout(location = 2) out vec2 uv;
layout(location = 3) flat out uint material;
layout(location = 4) flat out int layer;

void main()
{
    int c = gl_InstanceIndex;
    vec3 d = vertex_position - map_eye(c);
    float x = dot(d, map_tangent(c));
    float y = dot(d, map_bitangent(c));
    float z = dot(d, map_axis(c));
    float w = length(d) + z;
    position = vertex_position;
    normal = vertex_normal;
    uv = vertex_uv;
    material = vertex_material;
    layer = c;
    gl_Position = vec4(x, y, 0.5 * w, w);
    gl_ClipDistance[0] = map_member(c) < 0 ? -1.0 : z; /* nothing for an empty cluster */
    gl_Layer = c;
}
#endif

#ifdef FRAGMENT
#include "../shared/surface.glsl"

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
layout(location = 3) flat in uint material;
layout(location = 4) flat in int layer;

/* Unit direction of this texel. Texels outside the disk look behind the horizon and are never asked
 * for. */
vec3 texel_direction()
{
    vec2 p = gl_FragCoord.xy * (2.0 / float(MAP_SIZE)) - 1.0;
    float s = dot(p, p);
    vec3 d = vec3(2.0 * p, 1.0 - s) / (1.0 + s);
    return map_tangent(layer) * d.x + map_bitangent(layer) * d.y
        + map_axis(layer) * d.z;
}

void main()
{
    vec3 geometric = triangle_normal(position);
    vec3 albedo = surface_albedo(material, uv);
    vec3 eye = map_eye(layer);
    vec3 direction = texel_direction();
    float interpolated = length(position - eye);
    float cut = dot(position - eye, geometric) / dot(direction, geometric);
    /* Not where the texel's ray runs along the plane or misses it. */
    bool sound = cut > 0.5 * interpolated && cut < 2.0 * interpolated;
    float reach = sound ? cut : interpolated;
    vec3 point = sound ? eye + direction * cut : position;
    write_texel(point, reach, facing_normal(normal, geometric, eye - point), albedo);
    gl_FragDepth = clamp(reach / (2.5 * frame.scene_radius), 0.0, 1.0);
}
#endif
