/* Irradiance, W/m2, from all VPLs: sum of Phi / pi cos cos V / d^2. Background pixels have a zero
 * normal, so they get zero. */
#include "../ssvp/vpl.glsl"

void main()
{
    ivec2 p = min(invocation().xy, indirect_size() - 1); /* outside the frame: the last pixel */
    vec3 x = gbuffer_position(p).xyz;
    vec3 n = gbuffer_normal(p).xyz;
    float closest = 1e-8 * frame.scene_radius * frame.scene_radius;
    vec2 middle = vec2(0.5 * float(map_size));
    float bias = visibility_bias * (2.28 / float(map_size));
    vec3 sum = vec3(0.0);
    for (ClassVpl v : all_lights) {
        Sight s = sight(x - v.eye, v.tangent, v.bitangent, v.axis, middle);
        float seen = map_reach(ivec3(texel_of(s), v.layer)).r;
        bool lit = is_seen(s, v.tangent, v.bitangent, v.axis, n, seen, bias);
        float geometry = geometry_term(x - v.position, v.normal, v.disk, n, closest);
        sum += v.flux * (lit ? geometry : 0.0);
    }
    /* Half floats end at 65504. */
    if (all(equal(p, invocation().xy))) /* invocations beside the image repeat its edge */
        indirect_store(p, vec4(min(sum / PI, 60000.0), 1.0));
}
