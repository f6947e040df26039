/* First-bounce VPLs: Hammersley samples of the reflective shadow map (Dachsbacher, Stamminger 2005;
 * paper, section on VPL generation). A VPL is exactly one texel: a blend of texels at a silhouette
 * would float in the air. */
#include "../shared/space.glsl"
#include "../shared/surface.glsl"
#include "../shared/lighting.glsl"
#include "../shared/reuse.glsl"

void main()
{
    int k = invocation().x;
    if (k >= first_vpls)
        return;
    vec2 p = shift_square(rsm_points(k)) * float(rsm_size);
    ivec2 texel = min(ivec2(floor(p)), ivec2(rsm_size - 1));
    uint triangle = number(texel).x;
    bool lit = triangle > 0u; /* no surface: no light */
    vec2 size = vec2(2.0 * approximate_reciprocal(float(rsm_size)));
    Surface s = surface_at(max(triangle, 1u) - 1u, (vec2(texel) + 0.5) * size - 1.0, size,
                           light_view.view_projection);
    vec3 normal = facing_normal(s.hit_normal, s.geometric, to_light(s.hit_position));
    vec3 flux = s.hit_albedo * sample_flux(s.hit_position, float(first_vpls));
    vpls[k].position = lit ? s.hit_position : vec3(0.0);
    vpls[k].area = lit ? sample_area(s.hit_position, normal, float(first_vpls)) : 0.0;
    vpls[k].normal = lit ? normal : vec3(0.0);
    vpls[k].arriving = 0.0;
    vpls[k].flux = lit ? flux : vec3(0.0);
}
