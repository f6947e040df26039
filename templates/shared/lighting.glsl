/* Both kinds of light, and their shadow from the reflective shadow map. Includers need the
 * parameters rsm_size and shadow_bias. For shadows they define WITH_SHADOW and read the image
 * rsm_position (w is 1 on a surface). */

/* Fraction of a spot's intensity at the cosine of the angle to its axis: full within the inner half
 * angle, none beyond the outer, a smooth step of the cosine between. */
float spot_falloff(float cosine)
{
    float width = max(frame.light.cos_inner - frame.light.cos_outer, 1e-6);
    float t = clamp((cosine - frame.light.cos_outer) / width, 0.0, 1.0);
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
    float cosine = max(dot(n, l), 0.0);
    if (frame.light.kind == 0)
        return frame.light.color * cosine;
    vec3 d = frame.light.position - x;
    float square = max(dot(d, d), 1e-8 * frame.scene_radius * frame.scene_radius);
    return frame.light.color * (spot_falloff(-dot(l, frame.light.direction)) * cosine / square);
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
    float cosine = max(-dot(to_light(x), frame.light.direction), 0.0);
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
    float cosine = max(-dot(l, frame.light.direction), 0.0);
    return share * cosine * cosine * cosine * dot(d, d) / slope;
}

/* Position in the light's map, in texels, and whether x is inside the map. Outside, the position is
 * clamped to the border. It stays continuous up to the line behind a spot, since the divisor has a
 * lower bound at the cone. */
vec2 light_texel(vec3 x, out bool inside)
{
    vec4 clip = transform_point(frame.light_view.view_projection, x);
    float floor_w = frame.light.kind == 0 ? 0.0
        : max(frame.light.cos_outer, 0.05) * length(x - frame.light.position);
    vec2 ndc = clip.xy / max(clip.w, max(floor_w, 1e-12));
    inside = clip.w > 0.0 && abs(ndc.x) < 1.0 && abs(ndc.y) < 1.0;
    return clamp(ndc * 0.5 + 0.5, 0.0, 1.0) * float(rsm_size);
}

#ifdef WITH_SHADOW
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

/* Fraction of the light that reaches x: percentage-closer filtering (Reeves, Salesin, Cook 1987)
 * over 3x3 texels with the weights of a quadratic B-spline, so that it is continuous. bias is in
 * texels of the map at x. */
float light_visibility(vec3 x, vec3 n)
{
    bool inside;
    vec2 p = light_texel(x, inside);
    if (!inside)
        return 0.0; /* the map covers all that the light reaches */
    float along = max(dot(x - frame.light.position, frame.light.direction), 0.0);
    float depth = frame.light.kind == 0 ? 1.0 : along;
    float bias = shadow_bias * depth * sqrt(frame.light.area) / float(rsm_size);
    ivec2 middle = ivec2(floor(p));
    vec2 f = p - (vec2(middle) + 0.5);
    vec3 wx = spline(f.x), wy = spline(f.y);
    float sum = 0.0;
    for (int dy = -1; dy <= 1; dy++)
        for (int dx = -1; dx <= 1; dx++)
            sum += wx[dx + 1] * wy[dy + 1] * texel_light(middle + ivec2(dx, dy), x, n, bias);
    return sum;
}
#endif
