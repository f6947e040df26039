/* How much the light has changed since the last frame, from an even grid of 16x16 places of its
 * map: their irradiance then and now, with shadow. The mean over frames is shortened so that it is at
 * most accumulate_lag behind: the mean of N frames that change by c each is c (N - 1) / 2 behind.
 * When half of the light is another, it starts anew; and so it does after frames without a mean, or
 * with another number of bounces. */
#include "space.glsl"
#include "facing.glsl"
#include "shadow.glsl"
#include "triangle.glsl"

shared float changed[256];
shared float sent[256];

/* Sum of the channels; 0 where the map's texel shows a surface before x. */
float irradiance_at(vec3 x, vec3 n)
{
    vec4 clip = transform_point(frame.light_view.view_projection, x);
    vec2 ndc = clip.xy * reciprocal_close(max(clip.w, 1e-12));
    if (clip.w <= 0.0 || any(greaterThan(abs(ndc), vec2(1.0))))
        return 0.0;
    ivec2 texel = ivec2(floor((ndc * 0.5 + 0.5) * float(rsm_size)));
    vec3 e = unshadowed_irradiance(x, n) * texel_light(texel, x, n, texel_bias(x));
    return e.r + e.g + e.b;
}

void main()
{
    int lane = int(gl_LocalInvocationIndex);
    vec3 x = settled_light[lane].position;
    vec3 n = settled_light[lane].normal;
    float then = settled_light[lane].arriving;
    float now = then > 0.0 ? irradiance_at(x, n) : 0.0;
    changed[lane] = abs(now - then);
    sent[lane] = max(now, then);

    ivec2 texel = (ivec2(lane % 16, lane / 16) * 2 + 1) * rsm_size / 32;
    uint triangle = rsm_triangle(texel).x;
    x = rsm_position(texel).xyz;
    Triangle t = triangle_of(max(triangle, 1u) - 1u);
    vec3 origin = corner_position(t.a);
    vec3 geometric = cross(corner_position(t.b) - origin, corner_position(t.c) - origin);
    n = facing_normal(geometric, geometric, to_light(x));
    settled_light[lane].position = x;
    settled_light[lane].normal = n;
    settled_light[lane].arriving = triangle > 0u ? irradiance_at(x, n) : 0.0;
    barrier();
    for (int stride = 128; stride > 0; stride /= 2) {
        if (lane < stride) {
            changed[lane] += changed[lane + stride];
            sent[lane] += sent[lane + stride];
        }
        barrier();
    }
    if (lane == 0) {
        bool goes_on =
            settled_at[0].frame + 1u == frame.index && settled_at[0].bounces == bounces;
        settled_at[0].frame = frame.index;
        settled_at[0].bounces = bounces;
        float change = sent[0] > 0.0 ? changed[0] / sent[0] : 1.0;
        float frames = 1.0 + 2.0 * accumulate_lag * max(1.0 / max(change, 1e-6) - 2.0, 0.0);
        mean_frames[0] = goes_on ? min(frames, float(accumulate)) : 1.0;
    }
}
