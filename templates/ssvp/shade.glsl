/* Irradiance, W/m2, from the VPLs of a pixel's class; each class reads and writes its own pixels,
 * strided (Segovia et al. 2006). Formulae, "Shading": sum of Phi / pi (n_k . w)+ (n . -w)+ V / d^2,
 * times the number of classes. Background pixels have a zero normal, so they get zero. */
#include "vpl.glsl"

/* A receiver, and how it looks up maps. */
struct Receiver {
    vec3 x, n;
    vec2 middle; /* of a map, in texels */
    float bias;  /* radians */
    float closest; /* m2 */
};

Sight sight_of(ClassVpl v, Receiver r)
{
    return sight(r.x - v.eye, v.tangent, v.bitangent, v.axis, r.middle);
}

/* What hides an eye is no point: of its squared distance to the receiver, this share is surely free. */
const float FREE = 0.7;

/* Whether the map of a VPL's eye lets the receiver see it. `seen`: the map's reach in the direction of
 * the receiver. What hides the eye cannot hide a VPL that is nearer to the receiver than this. And it
 * says little about a VPL that is nearer to the receiver than to its eye. */
bool is_open(ClassVpl v, Receiver r, Sight s, float seen)
{
    vec3 d = r.x - v.position;
    float near = visibility_near > 0.0 ? approximate_max(FREE * square_to_surface(s, seen), v.near_square) : 0.0;
    return is_seen(s, v.tangent, v.bitangent, v.axis, r.n, seen, r.bias) || dot(d, d) < near;
}

void main()
{
    ivec2 p = interleave_pixel();
    /* Each class looks up the maps at a small offset. The filter over the tile turns this into
     * percentage-closer filtering, visibility_blur texels wide. */
    vec2 stratum = vec2(interleave_class() % tile.x, interleave_class() / tile.x) + 0.5;
    Receiver r;
    r.x = gbuffer_position(p).xyz;
    r.n = gbuffer_normal(p).xyz;
    r.middle = 0.5 * float(map_size) + visibility_blur * (stratum * (1.0 / vec2(tile)) - 0.5);
    /* Half the diagonal of a texel, where texels are largest. */
    r.bias = visibility_bias * (2.28 * approximate_reciprocal(float(map_size)));
    r.closest = 1e-8 * frame.scene_radius * frame.scene_radius;
    vec3 sum = vec3(0.0);

    for (ClassVpl v : first_range) {
        Sight s = sight_of(v, r);
        bool open = is_open(v, r, s, first_reach(ivec3(texel_of(s), v.layer)).r);
        float geometry = geometry_term(r.x - v.position, v.normal, v.disk, r.n, r.closest);
        sum += v.flux * (open ? geometry : 0.0);
    }
    /* Mesa's CPU drivers run all invocations of a workgroup up to here, and the code of one part fits
     * the processor's cache of instructions. */
    barrier();
    for (ClassVpl v : second_range) {
        Sight s = sight_of(v, r);
        bool open = second_visibility == 0 ||
                    (bounces > 1 && is_open(v, r, s, second_reach(ivec3(texel_of(s), v.layer)).r));
        float geometry = geometry_term(r.x - v.position, v.normal, v.disk, r.n, r.closest);
        sum += v.flux * (open ? geometry : 0.0);
    }

    /* Half floats end at 65504. */
    if (all(equal(p / pattern_tile, invocation().xy))) /* others repeat the last pixel of the class */
        irradiance_store(p, vec4(min(sum * (float(class_count) / PI), 60000.0), 1.0));
}
