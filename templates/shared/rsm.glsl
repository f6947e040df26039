/* Reflective shadow map (Dachsbacher, Stamminger 2005), of the numbers of the triangles that the light
 * sees: position with w = 1 on a surface. Where RSM_FLUX is defined, also the unit normal turned to the
 * light and the flux of a texel. */
#include "space.glsl"
#include "surface.glsl"
#include "lighting.glsl"

void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, rsm_position_size())))
        return;
    uint triangle = number(p).x;
    bool lit = triangle > 0u;
    vec2 texel = vec2(2.0 * approximate_reciprocal(float(rsm_size)));
    Surface s = surface_at(max(triangle, 1u) - 1u, (vec2(p) + 0.5) * texel - 1.0, texel,
                           light_view.view_projection);
    rsm_position_store(p, lit ? vec4(s.hit_position, 1.0) : vec4(0.0));
#ifdef RSM_FLUX
    vec3 normal = facing_normal(s.hit_normal, s.geometric, to_light(s.hit_position));
    vec3 flux = s.hit_albedo * sample_flux(s.hit_position, float(rsm_size) * float(rsm_size));
    rsm_normal_store(p, lit ? vec4(normal, 0.0) : vec4(0.0));
    rsm_flux_store(p, lit ? vec4(flux, 1.0) : vec4(0.0));
#endif
}
