/* Both kinds of light. */
#include "estimate.glsl"

/* Fraction of a spot's intensity at the cosine of the angle to its axis: full within the inner half
 * angle, none beyond the outer, a smooth step of the cosine between. */
float spot_falloff(float cosine)
{
    float width = max(frame.light.cos_inner - frame.light.cos_outer, 1e-6);
    float t = approximate_clamp((cosine - frame.light.cos_outer) * reciprocal_close(width), 1.0);
    return t * t * (3.0 - 2.0 * t);
}

/* Unit vector from x to the light. */
vec3 to_light(vec3 x)
{
    vec3 back = -frame.light.direction;
    return frame.light.kind == 0 ? back : unit_or(frame.light.position - x, back);
}

/* Irradiance at x with the unit normal n, W/m2, without shadow. */
vec3 unshadowed_irradiance(vec3 x, vec3 n)
{
    vec3 l = to_light(x);
    float cosine = approximate_max(dot(n, l), 0.0);
    if (frame.light.kind == 0)
        return frame.light.color * cosine;
    vec3 d = frame.light.position - x;
    float square = max(dot(d, d), 1e-8 * frame.scene_radius * frame.scene_radius);
    float falling = spot_falloff(-dot(l, frame.light.direction)) * cosine;
    return frame.light.color * (falling * reciprocal_close(square));
}

/* Reflected flux of one of `count` equal samples of the light's map that falls on x (formulae:
 * first bounce). Directional: E A / N, the receiver's cosine cancels against the foreshortened
 * patch. Spot: I(w) dw with the solid angle A cos^3 / N of a sample on the image plane at distance
 * 1. Times albedo; watts. */
vec3 sample_flux(vec3 x, float count)
{
    float share = frame.light.area / count;
    if (frame.light.kind == 0)
        return frame.light.color * share;
    float cosine = max(0.0, -dot(to_light(x), frame.light.direction));
    return frame.light.color * (spot_falloff(cosine) * share * cosine * cosine * cosine);
}

/* Area, m2, that one of `count` equal samples of the light's map represents at x, on a surface with
 * the unit normal n. At most ten times what the light sees at a grazing angle. */
float sample_area(vec3 x, vec3 n, float count)
{
    float share = frame.light.area / count;
    vec3 l = to_light(x);
    float slope = max(dot(n, l), 0.1);
    if (frame.light.kind == 0)
        return share / slope;
    vec3 d = frame.light.position - x;
    float cosine = max(0.0, -dot(l, frame.light.direction));
    return share * cosine * cosine * cosine * dot(d, d) / slope;
}
