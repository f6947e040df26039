/* Temporal antialiasing: reprojection, clamp to the neighbourhood, exponential average. Colours are
 * weighed by 1 / (1 + luma), lest single bright pixels flicker. */
#include "../shared/space.glsl"

float luma(vec3 c)
{
    return dot(c, vec3(0.2126, 0.7152, 0.0722));
}

vec4 weighed(vec4 c)
{
    return vec4(c.rgb / (1.0 + luma(c.rgb)), c.a);
}

/* Where the last frame showed what texel q shows, relative to where this frame shows it; in uv. The
 * background is taken for a point on the far plane. */
vec2 motion(ivec2 q, vec2 size)
{
    vec2 ndc = 2.0 * (vec2(q) + 0.5) / size - 1.0;
    vec4 x = gbuffer_position(q);
    mat4 m = frame.camera.inverse_view_projection;
    vec4 far = m[0] * ndc.x + m[1] * ndc.y + m[2] + m[3];
    vec3 position = x.w > 0.0 ? x.xyz : far.xyz / far.w;
    vec4 clip = transform_point(frame.previous_camera.view_projection, position);
    vec2 still = ndc - 2.0 * frame.jitter / size; /* without jitter */
    return clip.w > 0.0 ? 0.5 * (clip.xy / clip.w - still) : vec2(2.0); /* 2: not in the picture */
}

void main()
{
    ivec2 size = radiance_size();
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, size)))
        return;
    vec4 now = weighed(lit(p));
    vec4 least = now, most = now;
    ivec2 nearest = p;
    for (int y = -1; y <= 1; y++) {
        for (int x = -1; x <= 1; x++) {
            ivec2 q = clamp(p + ivec2(x, y), ivec2(0), size - 1);
            vec4 c = weighed(lit(q));
            least = min(least, c);
            most = max(most, c);
            float depth = gbuffer_position(q).w;
            float best = gbuffer_position(nearest).w;
            /* Edges move with the surface in front. */
            nearest = depth > 0.0 && (best <= 0.0 || depth < best) ? q : nearest;
        }
    }
    vec2 uv = (vec2(p) + 0.5) / vec2(size) + motion(nearest, vec2(size));
    bool known = frame.first == 0u && temporal == 1 && uv == clamp(uv, 0.0, 1.0);
    vec4 last = clamp(weighed(resolved_sample(uv)), least, most);
    vec4 mixed = known ? mix(last, now, fresh) : now;
    mixed.rgb /= max(1.0 - luma(mixed.rgb), 1e-4);
    radiance_store(p, mixed);
}
