    /* Included inside main, after vpl.glsl: irradiance, W/m2, at the position x with the unit normal n,
     * from the VPLs of this class, into `shaded`. Formulae, "Shading": sum of Phi / pi (n_k . w)+ (n .
     * -w)+ V / d^2, times the number of classes. Background pixels have a zero normal, so they come out
     * zero. */
    float closest = 1e-8 * frame.scene_radius * frame.scene_radius;
    /* Each class looks up the maps a little beside the receiver; the filter over the tile then
     * makes that percentage-closer filtering, visibility_blur texels wide. */
    vec2 stratum = vec2(interleave_class() % tile.x, interleave_class() / tile.x) + 0.5;
    vec2 middle = 0.5 * float(paraboloid_size) + visibility_blur * (stratum / vec2(tile) - 0.5);
    /* Half a texel's diagonal in radians at the centre of a map, where dw = 4 dA. */
    float bias = visibility_bias * (2.8284271 / float(paraboloid_size));
    vec3 sum = vec3(0.0);

    for (ClassVpl v : first_range) {
        Sight s = sight(v, x, n, closest, middle);
        sum += v.flux * (s.geometry * visibility(s, v, n, paraboloid_distance(s.texel).r, bias));
    }
    for (ClassVpl v : second_range) {
        if (second_clusters > 0) {
            Sight s = sight(v, x, n, closest, middle);
            sum += v.flux * (s.geometry * visibility(s, v, n, second_distance(s.texel).r, bias));
        } else {
            vec2 term = geometry_term(v, x, n, closest);
            sum += v.flux * (term.x / term.y);
        }
    }

    /* Half floats end at 65504. */
    vec4 shaded = vec4(min(sum * (float(class_count) / PI), 60000.0), 1.0);
