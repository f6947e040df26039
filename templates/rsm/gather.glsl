/* One bounce by gathering pixel lights of the reflective shadow map (Dachsbacher, Stamminger 2005,
 * Equation 1), without visibility. The pattern covers a disk of the map; the weighted mean of its
 * texels stands for all texels of the disk. Each pixel of a tile rotates the pattern by another
 * angle; the filter over the tile removes the pattern. */
#include "../shared/space.glsl"
#include "../shared/shadow.glsl"

void main()
{
    ivec2 size = irradiance_size();
    /* No early return: it would keep the taps out of registers. */
    ivec2 p = min(invocation().xy, size - 1);
    vec3 x = gbuffer_position(p).xyz;
    vec3 n = gbuffer_normal(p).xyz;
    bool inside;
    float radius = gather_radius * float(rsm_size);
    vec2 middle = light_texel(x, inside);
    middle = clamp(middle, radius, float(rsm_size) - radius); /* keep the whole disk on the map */
    float angle = 2.0 * PI * float(pattern_class(p)) / float(pattern_classes);
    vec2 turn = radius * vec2(cos(angle), sin(angle));
    float closest = 1e-8 * frame.scene_radius * frame.scene_radius;
    /* cos cos / (d^2 + bound) never exceeds 1 / bound. */
    float bound = frame.scene_radius * frame.scene_radius / geometry_clamp;
    vec3 sum = vec3(0.0);

    for (Tap tap : pattern_taps) {
        vec2 at = middle + vec2(turn.x * tap.offset.x - turn.y * tap.offset.y,
                                turn.y * tap.offset.x + turn.x * tap.offset.y);
        ivec2 within = clamp(ivec2(at), ivec2(0), ivec2(rsm_size - 1)); /* against rounding */
        vec3 d = x - rsm_position(within).xyz;
        float square = max(dot(d, d), closest);
        float cosines = max(dot(rsm_normal(within).xyz, d), 0.0) * max(0.0, -dot(n, d));
        float below = reciprocal_estimate(square * (square + bound));
        sum += rsm_flux(within).rgb * (tap.weight * cosines * below);
    }

    /* Texels in the disk, pi radius^2, times flux / pi. Half floats end at 65504. */
    if (all(equal(p, invocation().xy))) /* invocations beside the image repeat its edge */
        irradiance_store(p, vec4(min(sum * (radius * radius), 60000.0), 1.0));
}
