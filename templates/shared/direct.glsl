/* Radiance that surfaces send of the light itself, with its shadow. The pass binds the surfaces as
 * `position`, `normal` and `albedo`, the result as `sent`. */
#include "space.glsl"
#include "shadow.glsl"

void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, sent_size())))
        return;
    vec4 x = position(p);
    vec3 n = normal(p).xyz;
    vec3 irradiance = unshadowed_irradiance(x.xyz, n) * light_visibility(x.xyz, n);
    float surface = x.w > 0.0 ? 1.0 : 0.0;
    vec3 radiance = albedo(p).rgb * irradiance * (surface * (1.0 / PI));
    sent_store(p, vec4(min(radiance, 60000.0), surface)); /* half floats end at 65504 */
}
