/* Directional occlusion and one bounce (Ritschel et al. 2009). Directions are as dense as their
 * cosine, so that each one brings the same share of the sky. */
#include "../shared/space.glsl"

void main()
{
    ivec2 size = irradiance_size();
    ivec2 p = min(invocation().xy, size - 1); /* no early return: it costs registers */
    vec4 x = gbuffer_position(p);
    vec3 n = gbuffer_normal(p).xyz;
    vec3 tangent, bitangent;
    tangent_frame(n, tangent, bitangent);
    float part = float(pattern_class(p)) / float(pattern_classes);
    float angle = 2.0 * PI * part;
    vec2 turn = vec2(cos(angle), sin(angle));
    float most = radius * frame.scene_radius;
    float closest = 1e-4 * most * most;
    float disk = most * most / float(samples); /* squared radius */
    vec3 sum = vec3(0.0);

    for (Tap tap : pattern_taps) {
        vec2 d = vec2(turn.x * tap.direction.x - turn.y * tap.direction.y,
                      turn.y * tap.direction.x + turn.x * tap.direction.y);
        vec3 to = tangent * d.x + bitangent * d.y + n * tap.direction.z;
        vec4 clip = transform_point(frame.camera.view_projection,
                                    x.xyz + to * (most * fract(tap.reach + part)));
        vec2 ndc = approximate_divide(clip.xy, max(clip.w, 1e-12));
        bool inside = clip.w > 0.0 && abs(ndc.x) < 1.0 && abs(ndc.y) < 1.0;
        ivec2 texel = min(ivec2(clamp(ndc * 0.5 + 0.5, 0.0, 1.0) * vec2(size)), size - 1);
        vec4 y = gbuffer_position(texel);
        vec3 across = y.xyz - x.xyz;
        float square = max(dot(across, across), closest);
        /* Hidden by a surface in reach: that is the occluder. */
        bool hidden = inside && y.w > 0.0 && y.w < clip.w && square < most * most;
        float leaving = max(0.0, -dot(gbuffer_normal(texel).xyz, across));
        float arriving = max(dot(n, across), 0.0);
        /* The occluder stands for a disk, an equal part of a disk of the radius. A disk, unlike a
         * point, bounds the light nearby. */
        float geometry = approximate_divide(most * most * leaving * arriving, square * (square + disk));
        vec3 bounce = direct(texel).rgb * (bleeding * geometry);
        vec3 light = sky * max(to.y, 0.0);
        sum += hidden ? bounce : light;
    }
    vec3 irradiance = sum * (x.w > 0.0 ? PI / float(samples) : 0.0);
    if (all(equal(p, invocation().xy))) /* invocations beside the image repeat its edge */
        irradiance_store(p, vec4(min(irradiance, 60000.0), 1.0)); /* half floats end at 65504 */
}
