/* Light that VPLs lose nearby. A VPL is a disk, so receivers closer than its radius get too little of
 * its surface: they lose the share disk cos / (d^2 + disk cos). Here they get it from lit surfaces
 * around the pixel (Novak, Engelhardt, Dachsbacher, "Screen-Space Bias Compensation for Interactive
 * High-Quality Global Illumination with Virtual Point Lights", 2011). What the screen does not show
 * stays lost.
 *
 * Disks of first-bounce VPLs are `area` / cosine to the light. Second-bounce VPLs lie as dense as
 * light arrives, so their disks are `power` / irradiance, and the irradiance is the last frame's. */
#include "../shared/space.glsl"
#include "../shared/reuse.glsl"
#include "../shared/lighting.glsl"

/* Cosine and sine of the golden angle, by which samples turn. */
const vec2 GOLDEN = vec2(-0.73736888, 0.67549029);

/* How a pixel samples its surroundings. */
struct Around {
    vec3 x, n;
    vec3 light;           /* unit vector to it */
    float pixel;          /* width at depth 1, m */
    float closest;        /* m2 */
    float area, power;    /* of disks, as above */
    float radius, inside; /* of the samples, in pixels; place on it */
    vec2 way;             /* of the first sample */
    ivec2 moved;          /* where the last frame had the surface, relative to the pixel */
};

Around around_pixel(ivec2 p, ivec2 size)
{
    Around a;
    vec4 x = gbuffer_position(p);
    a.x = x.xyz;
    a.n = gbuffer_normal(p).xyz;
    a.light = to_light(a.x);
    a.pixel = 2.0 * reciprocal_close(frame.camera.projection[1].y * float(size.y));
    float pixel_here = max(a.pixel * x.w, 1e-12);
    a.closest = near_closest * pixel_here * pixel_here;
    a.area = softness * (1.0 / PI) * sample_area(a.x, a.light, float(first_vpls));
    a.power = bounces > 1 ? softness * (1.0 / PI) * second_vpl[0].arriving : 0.0;
    float reach = near_reach * sqrt_estimate(max(a.area, 1e-12));
    a.radius = min(reach * reciprocal_estimate(pixel_here), 0.5 * float(size.y));
    vec4 clip = transform_point(frame.previous_camera.view_projection, a.x);
    vec2 ndc = clip.xy * reciprocal_close(max(clip.w, 1e-12));
    a.moved = ivec2(clamp(floor((ndc * 0.5 + 0.5) * vec2(size)), -1.0, 65536.0)) - p;
    int place = p.x % tile.x + tile.x * (p.y % tile.y);
    vec2 u = fract(float(place) * vec2(0.75487767, 0.56984029) + pattern_shift());
    a.inside = u.x;
    a.way = vec2(cos(2.0 * PI * u.y), sin(2.0 * PI * u.y));
    return a;
}

/* Irradiance by the surface of pixel q, `away` pixels from the receiver's, but for the factors that
 * all samples share. A pixel's surface has the area pixel^2 depth^3 / facing. */
vec3 light_of(Around a, ivec2 q, ivec2 size, float away)
{
    vec4 y = gbuffer_position(q);
    vec3 m = gbuffer_normal(q).xyz;
    vec3 d = y.xyz - a.x;
    float square = max(dot(d, d), a.closest);
    float cube = square * sqrt_estimate(square);
    float leaving = approximate_max(-dot(m, d), 0.0);
    float arriving = approximate_max(dot(a.n, d), 0.0);
    float facing = approximate_max(-dot(m, y.xyz - frame.camera.position), 0.1 * y.w);
    float above = leaving * leaving * arriving * y.w * y.w * y.w * away;
    float below = max(square * square * facing, 1e-20);
    float slope = approximate_max(dot(m, a.light), 0.1); /* as in sample_area */
    float first = a.area * reciprocal_estimate(max(below * (slope * cube + a.area * leaving), 1e-30));
    vec3 lit = settled(clamp(q + a.moved, ivec2(0), size - 1)).rgb;
    float all_lit = lit.r + lit.g + lit.b;
    float second =
        a.power * reciprocal_estimate(max(below * (all_lit * cube + a.power * leaving), 1e-30));
    vec3 light = sent(q).rgb * first + gbuffer_albedo(q).rgb * lit * (second * (1.0 / PI));
    return y.w > 0.0 ? light * above : vec3(0.0);
}

void main()
{
    ivec2 size = irradiance_size();
    ivec2 p = min(invocation().xy, size - 1); /* no early return: it costs registers */
    Around a = around_pixel(p, size);
    vec3 sum = vec3(0.0);
    for (int k = 0; k < near_taps; k++) {
        float away = a.radius * fract(a.inside + float(k) * (1.0 / float(near_taps)));
        ivec2 wanted = p + ivec2(floor(a.way * away + 0.5));
        a.way = vec2(a.way.x * GOLDEN.x - a.way.y * GOLDEN.y,
                     a.way.y * GOLDEN.x + a.way.x * GOLDEN.y);
        ivec2 q = clamp(wanted, ivec2(0), size - 1);
        vec3 light = light_of(a, q, size, away);
        sum += q == wanted && q != p ? light : vec3(0.0);
    }
    sum *= 2.0 * PI * a.pixel * a.pixel * a.radius * (1.0 / float(near_taps));
    if (p == invocation().xy)
        irradiance_store(p, vec4(min(irradiance(p).rgb + sum, 60000.0), 1.0));
}
