/* Reflective shadow map (Dachsbacher, Stamminger 2005), of the numbers of the triangles that the light
 * sees. Position with w = 1 on a surface, unit normal turned to the light, and albedo, or the flux of
 * a texel where RSM_FLUX is defined. */
#include "space.glsl"
#include "surface.glsl"
#include "lighting.glsl"

void store(ivec2 p, vec4 position, vec3 normal, vec4 color)
{
    rsm_position_store(p, position);
    rsm_normal_store(p, vec4(normal, 0.0));
#ifdef RSM_FLUX
    rsm_flux_store(p, color);
#else
    rsm_albedo_store(p, color);
#endif
}

void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, rsm_position_size())))
        return;
    uint triangle = number(p).x;
    if (triangle == 0u) {
        store(p, vec4(0.0), vec3(0.0), vec4(0.0));
        return;
    }
    vec2 texel = vec2(2.0 / float(rsm_size));
    Surface s =
        surface_at(triangle - 1u, (vec2(p) + 0.5) * texel - 1.0, texel, light_view.view_projection);
#ifdef RSM_FLUX
    vec3 color = s.hit_albedo * sample_flux(s.hit_position, float(rsm_size) * float(rsm_size));
#else
    vec3 color = s.hit_albedo;
#endif
    store(p, vec4(s.hit_position, 1.0), facing_normal(s.hit_normal, s.geometric, to_light(s.hit_position)),
          vec4(color, 1.0));
}
