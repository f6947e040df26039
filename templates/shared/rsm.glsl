/* Reflective shadow map (Dachsbacher, Stamminger 2005): what the light sees. Position with w = 1 on
 * a surface, unit normal turned to the light, and albedo, or the flux of a texel where RSM_FLUX is
 * defined. */
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
#include "lighting.glsl"

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
layout(location = 3) flat in uint material;

void main()
{
    vec3 geometric = triangle_normal(position);
    vec3 albedo = surface_albedo(material, uv);
    rsm_position = vec4(position, 1.0);
    rsm_normal = vec4(facing_normal(normal, geometric, to_light(position)), 0.0);
#ifdef RSM_FLUX
    rsm_flux = vec4(albedo * sample_flux(position, float(rsm_size) * float(rsm_size)), 1.0);
#else
    rsm_albedo = vec4(albedo, 1.0);
#endif
}
#endif
