/* Radiance: direct light with its shadow plus the filtered indirect irradiance, times albedo / pi.
 * The filter must not blur textures, so albedo comes after it. Alpha 0 marks the background. */
#include "space.glsl"
#include "shadow.glsl"

void main()
{
    ivec2 size = radiance_size();
    ivec2 p = invocation().xy;
    if (p.x >= size.x || p.y >= size.y)
        return;
    vec4 x = gbuffer_position(p);
    vec3 n = gbuffer_normal(p).xyz;
    float surface = x.w > 0.0 ? 1.0 : 0.0;
    vec3 direct = unshadowed_irradiance(x.xyz, n);
    direct *= light_visibility(x.xyz, n);
    vec3 irradiance = direct + indirect(p).rgb;
    radiance_store(p, vec4(gbuffer_albedo(p).rgb * irradiance * (surface * (1.0 / PI)), surface));
}
