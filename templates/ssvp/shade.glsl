/* Irradiance, W/m2, from the VPLs of a pixel's class; each class reads and writes its own pixels,
 * strided (Segovia et al. 2006). Formulae, "Shading": sum of Phi / pi (n_k . w)+ (n . -w)+ V / d^2,
 * times the number of classes. Background pixels have a zero normal, so they get zero. */
#include "vpl.glsl"

void main()
{
    ivec2 p = interleave_pixel();
    vec3 x = gbuffer_position(p).xyz;
    vec3 n = gbuffer_normal(p).xyz;
    float closest = 1e-8 * frame.scene_radius * frame.scene_radius;
    /* Each class looks up the maps at a small offset. The filter over the tile turns this into
     * percentage-closer filtering, visibility_blur texels wide. */
    vec2 stratum = vec2(interleave_class() % tile.x, interleave_class() / tile.x) + 0.5;
    vec2 middle = 0.5 * float(map_size) + visibility_blur * (stratum * (1.0 / vec2(tile)) - 0.5);
    /* Half the diagonal of a texel, in radians, where texels are largest. */
    float bias = visibility_bias * (2.28 * approximate_reciprocal(float(map_size)));
    vec3 sum = vec3(0.0);

    /* Each barrier() keeps the code small: Mesa's CPU drivers run all invocations of a workgroup up to
     * it, and the code of one part fits the processor's cache of instructions.
     *
     * All VPLs of a cluster share the map of its eye. It says how far away that is which hides the
     * eye: VPLs nearer than this are visible. A VPL nearer than its eye is visible, too: what hides
     * the eye says little about it. */
    bool some = visibility_near > 0.0;
    float first_open[first_eyes_length];
    int k = 0;
    for (Eye e : first_eye_range) {
        Sight s = sight(x - e.position, e.tangent, e.bitangent, e.axis, middle);
        float seen = first_reach(ivec3(texel_of(s), e.layer)).r;
        bool open = is_seen(s, e.tangent, e.bitangent, e.axis, n, seen, bias);
        first_open[k++] = open ? 1e30 : some ? square_to_surface(s, seen) : 0.0;
    }
    barrier();
    for (ClassVpl v : first_range) {
        vec3 d = x - v.position;
        float geometry = geometry_term(d, v.normal, v.disk, n, closest);
        bool open = dot(d, d) < approximate_max(first_open[v.eye], v.near_square);
        sum += v.flux * (open ? geometry : 0.0);
    }
    barrier();
    float second_open[second_eyes_length];
    k = 0;
    for (Eye e : second_eye_range) {
        Sight s = sight(x - e.position, e.tangent, e.bitangent, e.axis, middle);
        float seen = second_reach(ivec3(texel_of(s), e.layer)).r;
        bool open = is_seen(s, e.tangent, e.bitangent, e.axis, n, seen, bias);
        second_open[k++] = open ? 1e30 : some ? square_to_surface(s, seen) : 0.0;
    }
    barrier();
    for (ClassVpl v : second_range) {
        vec3 d = x - v.position;
        float geometry = geometry_term(d, v.normal, v.disk, n, closest);
        bool open = second_visibility == 0 || dot(d, d) < approximate_max(second_open[v.eye], v.near_square);
        sum += v.flux * (open ? geometry : 0.0);
    }

    /* Half floats end at 65504. */
    if (all(equal(p / pattern_tile, invocation().xy))) /* others repeat the last pixel of the class */
        irradiance_store(p, vec4(min(sum * (float(class_count) / PI), 60000.0), 1.0));
}
