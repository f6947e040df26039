/* Adds the bloom, then looks codes up in the table: filtered within two slices of blue, mixed
 * between them. */
#include "../shared/srgb.glsl"

vec3 looked_up(vec3 codes)
{
    float last = float(steps - 1);
    float slice = codes.b * last;
    float lower = min(floor(slice), last - 1.0);
    vec2 at = (codes.rg * last + 0.5) / vec2(steps * steps, steps);
    vec3 below = table_sample(at + vec2(lower / float(steps), 0.0)).rgb;
    vec3 above = table_sample(at + vec2((lower + 1.0) / float(steps), 0.0)).rgb;
    return mix(below, above, slice - lower);
}

void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, graded_size())))
        return;
    vec2 uv = (vec2(p) + 0.5) / vec2(graded_size());
    vec3 light = clamp(photo(p).rgb + bloom * glow_sample(uv).rgb, 0.0, 1.0);
    vec3 codes = vec3(srgb(light.r), srgb(light.g), srgb(light.b));
    graded_store(p, vec4(mix(codes, looked_up(codes), grade), 1.0));
}
