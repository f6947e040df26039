/* First-bounce VPLs: Hammersley samples of the reflective shadow map (Dachsbacher, Stamminger 2005;
 * paper, section on VPL generation). A VPL is exactly one texel: a blend of texels at a silhouette
 * would float in the air. */
#include "../shared/space.glsl"
#include "../shared/lighting.glsl"
#include "reuse.glsl"

void main()
{
    int k = invocation().x;
    if (k >= first_vpls)
        return;
    vec2 p = shift_square(rsm_points(k)) * float(rsm_size);
    ivec2 texel = min(ivec2(floor(p)), ivec2(rsm_size - 1));
    vec4 x = rsm_position(texel);
    vec3 flux = rsm_albedo(texel).rgb * sample_flux(x.xyz, float(first_vpls));
    vpls[k].position = x.xyz;
    vpls[k].area = sample_area(x.xyz, rsm_normal(texel).xyz, float(first_vpls));
    vpls[k].normal = rsm_normal(texel).xyz;
    vpls[k].arriving = 0.0;
    vpls[k].flux = x.w > 0.0 ? flux : vec3(0.0); /* no surface: no light */
}
