/* Irradiance, W/m2, from the VPLs of a pixel's class, with soft visibility by cluster. */
#include "../ssvp/vpl.glsl"

/* Whether the eye sees the receiver, with the map shifted by some texels. `apart`: how far the map's
 * surface lies before the receiver, as the difference of inverse reaches. */
bool sees(ClusterView e, int layer, vec3 d, vec3 n, vec2 shift, float closest, out float apart)
{
    float bias = visibility_bias * (2.28 * approximate_reciprocal(float(map_size)));
    vec2 middle = vec2(0.5 * float(map_size)) + shift;
    Sight s = sight(d, e.tangent, e.bitangent, e.normal, middle);
    float seen = map_reach(ivec3(texel_of(s), layer)).r;
    apart = approximate_reciprocal(max(seen, 0.1 * s.reach)) - approximate_reciprocal(s.reach);
    return is_seen(s, e.tangent, e.bitangent, e.normal, n, seen, bias);
}

/* Share of the area light around an eye that x sees, by percentage-closer soft shadows (Fernando
 * 2005): the mean distance of occluders gives the width of the penumbra, so of the filter. Each
 * class turns the four taps of both steps by another angle; the filter over the tile averages the
 * classes. */
float visible(ClusterView e, int layer, vec3 x, vec3 n, vec2 turn, float closest)
{
    vec3 d = x - e.position;
    float far = approximate_sqrt(max(dot(d, d), closest));
    /* A texel's side is sqrt(2 PI) / map_size in radians, on average. */
    float size = 0.4 * float(map_size) * light_size * approximate_sqrt(e.area * (1.0 / PI));
    vec2 side = vec2(-turn.y, turn.x);
    vec2 taps[4] = vec2[](0.25 * turn, 0.5 * side, -0.75 * turn, -side);
    float before = 0.0;
    float hidden = 0.0;
    float lit = 0.0;
    float apart;
    for (int k = 0; k < 4; k++) {
        bool open = sees(e, layer, d, n, taps[k] * approximate_divide(size, far), closest, apart);
        before += open ? 0.0 : apart;
        hidden += open ? 0.0 : 1.0;
    }
    float width = approximate_divide(size * max(before, 0.0), max(hidden, 1.0));
    for (int k = 0; k < 4; k++)
        lit += sees(e, layer, d, n, taps[k] * width, closest, apart) ? 0.25 : 0.0;
    return lit;
}

void main()
{
    ivec2 p = interleave_pixel();
    vec3 x = gbuffer_position(p).xyz;
    vec3 n = gbuffer_normal(p).xyz;
    float closest = 1e-8 * frame.scene_radius * frame.scene_radius;
    float angle = 0.5 * PI * (float(interleave_class()) + 0.5) / float(class_count);
    vec2 turn = vec2(cos(angle), sin(angle));
    float open[clusters];
    int c = 0;
    for (ClusterView e : areas) {
        open[c] = visible(e, c, x, n, turn, closest);
        c++;
    }
    vec3 sum = vec3(0.0);
    for (ClassVpl v : own) {
        float geometry = geometry_term(x - v.position, v.normal, v.disk, n, closest);
        sum += v.flux * (geometry * open[v.cluster]);
    }
    /* Half floats end at 65504. */
    if (all(equal(p / pattern_tile, invocation().xy))) /* others repeat the last pixel of the class */
        irradiance_store(p, vec4(min(sum * (float(class_count) / PI), 60000.0), 1.0));
}
