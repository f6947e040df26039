/* Radiance that surfaces send of the light itself, with its shadow. */
#define WITH_SHADOW
#include "space.glsl"
#include "lighting.glsl"

void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, direct_size())))
        return;
    vec4 x = gbuffer_position(p);
    vec3 n = gbuffer_normal(p).xyz;
    vec3 irradiance = unshadowed_irradiance(x.xyz, n) * light_visibility(x.xyz, n);
    float surface = x.w > 0.0 ? 1.0 : 0.0;
    /* Half floats end at 65504. */
    vec3 sent = min(gbuffer_albedo(p).rgb * irradiance * (surface / PI), 60000.0);
    direct_store(p, vec4(sent, surface));
}
