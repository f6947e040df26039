/* Shadow of either light from the reflective shadow map. Includers need the parameters rsm_size and
 * shadow_bias and read the image rsm_position (w is 1 on a surface). */
#include "lighting.glsl"

/* Position in the light's map, in texels, and whether x is inside the map. Outside, the position is
 * clamped to the border. It stays continuous up to the line behind a spot, since the divisor has a
 * lower bound at the cone. */
vec2 light_texel(vec3 x, out bool inside)
{
    vec3 way = frame.light.position - x;
    vec4 clip = transform_point(frame.light_view.view_projection, x);
    float floor_w = frame.light.kind == 0 ? 0.0
        : max(frame.light.cos_outer, 0.05) * sqrt_estimate(dot(way, way));
    vec2 ndc = clip.xy * reciprocal_close(max(clip.w, max(floor_w, 1e-12)));
    inside = clip.w > 0.0 && abs(ndc.x) < 1.0 && abs(ndc.y) < 1.0;
    return vec2(approximate_clamp(ndc.x * 0.5 + 0.5, 1.0), approximate_clamp(ndc.y * 0.5 + 0.5, 1.0)) * float(rsm_size);
}

/* 0 if the surface in one texel lies before the tangent plane of the receiver, so between it and
 * the light; else 1. Unlike a depth comparison this needs no slope bias, since the receiver's own
 * plane is never before itself. */
float texel_light(ivec2 texel, vec3 x, vec3 n, float bias)
{
    vec4 q = rsm_position(clamp(texel, ivec2(0), ivec2(rsm_size - 1)));
    return q.w > 0.0 && dot(n, q.xyz - x) > bias ? 0.0 : 1.0;
}

vec3 spline(float f)
{
    return vec3(0.5 * (0.5 - f) * (0.5 - f), 0.75 - f * f, 0.5 * (0.5 + f) * (0.5 + f));
}

/* shadow_bias texels of the map at x, in m. */
float texel_bias(vec3 x)
{
    float along = approximate_max(dot(x - frame.light.position, frame.light.direction), 0.0);
    float depth = frame.light.kind == 0 ? 1.0 : along;
    return shadow_bias * depth * sqrt_estimate(frame.light.area) *
           reciprocal_estimate(float(rsm_size));
}

/* Fraction of the light that reaches x: percentage-closer filtering (Reeves, Salesin, Cook 1987)
 * over 3x3 texels with the weights of a quadratic B-spline, so that it is continuous. */
float light_visibility(vec3 x, vec3 n)
{
    bool inside;
    vec2 p = light_texel(x, inside);
    if (!inside)
        return 0.0; /* the map covers all that the light reaches */
    float bias = texel_bias(x);
    vec2 low = floor(p);
    ivec2 middle = ivec2(approximate_int(low.x), approximate_int(low.y));
    vec2 f = p - (low + 0.5);
    vec3 wx = spline(f.x), wy = spline(f.y);
    float sum = 0.0;
    for (int dy = -1; dy <= 1; dy++)
        for (int dx = -1; dx <= 1; dx++)
            sum += wx[dx + 1] * wy[dy + 1] * texel_light(middle + ivec2(dx, dy), x, n, bias);
    return sum;
}
