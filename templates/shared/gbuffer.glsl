/* G-buffer: what the camera sees. Position with the depth along the view in w (0: background), unit
 * normal turned to the camera, albedo. Includers that define PEEL get the layer behind
 * near_position. */
#include "space.glsl"

#ifdef VERTEX
layout(location = 0) out vec3 position;
layout(location = 1) out vec3 normal;
layout(location = 2) out vec2 uv;
layout(location = 3) flat out uint material;

void main()
{
    position = vertex_position;
    normal = vertex_normal;
    uv = vertex_uv;
    material = vertex_material;
    gl_Position = transform_point(view.view_projection, vertex_position);
}
#endif

#ifdef FRAGMENT
#include "surface.glsl"

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
layout(location = 3) flat in uint material;

void main()
{
    vec3 geometric = triangle_normal(position);
    vec3 albedo = surface_albedo(material, uv);
    float depth = max(dot(position - view.position, view.direction), 1e-12);
#ifdef PEEL
    ivec2 p = ivec2(gl_FragCoord.xy);
    if (depth <= near_position(p).w + separation * frame.scene_radius)
        discard;
#endif
    vec3 to_eye = unit_or(view.position - position, -view.direction);
    gbuffer_position = vec4(position, depth);
    gbuffer_normal = vec4(facing_normal(normal, geometric, to_eye), 0.0);
    gbuffer_albedo = vec4(albedo, 1.0);
}
#endif
