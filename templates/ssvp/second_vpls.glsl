/* Second-bounce VPLs: uniform samples of the unit disk in each cluster's paraboloid map. With r the
 * distance to the centre of the disk, Phi_2 = rho Phi_C 4 (1 - r^2) / ((1 + r^2)^3 N), the solid
 * angle of a texel times the cosine of the emitter (derived in the notes on formulae from dw = 4 dA
 * / (1 + r^2)^2 and cos = (1 - r^2) / (1 + r^2)); the weights sum to 1. */
#include "reuse.glsl"

void main()
{
    int k = invocation().x;
    if (k >= second_total)
        return;
    int c = k / second_per_cluster;
    vec2 p = shift_disk(disk_points(k % second_per_cluster));
    ivec2 texel = ivec2(floor((p * 0.5 + 0.5) * float(paraboloid_size)));
    texel = clamp(texel, ivec2(0), ivec2(paraboloid_size - 1));
    ivec3 at = ivec3(texel, c);
    vec4 x = paraboloid_position(at);
    float s = min(dot(p, p), 1.0);
    float cube = (1.0 + s) * (1.0 + s) * (1.0 + s);
    float weight = 4.0 * (1.0 - s) / (cube * float(second_per_cluster));
    vec3 flux = paraboloid_albedo(at).rgb * cluster_views[c].flux * weight;
    second_vpl[k].position = x.xyz;
    second_vpl[k].normal = paraboloid_normal(at).xyz;
    second_vpl[k].flux = x.w > 0.0 ? flux : vec3(0.0); /* the light left the scene */
}
