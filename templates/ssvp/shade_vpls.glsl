    /* Included inside main: irradiance, W/m2, at the position x with the unit normal n, from the
     * VPLs of this class, into `shaded`. Formulae, "Shading": sum of Phi / pi (n_k . w)+ (n . -w)+
     * V / d^2, times the number of classes.
     *
     * No branch and no early return: drivers that run on CPUs then keep the VPLs in registers.
     * Background pixels have a zero normal, so they come out zero. Cosines stay unnormalised and
     * one division serves the geometry term and the paraboloid projection. Lengths are bounded from
     * below where they only guard a division. */
    float closest = 1e-8 * frame.scene_radius * frame.scene_radius;
    /* cos cos / (d^2 + bound) never exceeds 1 / bound; a hard minimum would show as discs. */
    float bound = frame.scene_radius * frame.scene_radius / geometry_clamp;
    float half_size = 0.5 * float(paraboloid_size);
    /* Each class looks up the maps a little beside the receiver; the filter over the tile then
     * makes that percentage-closer filtering, visibility_blur texels wide. */
    vec2 stratum = vec2(interleave_class() % tile.x, interleave_class() / tile.x) + 0.5;
    vec2 middle = half_size + visibility_blur * (stratum / vec2(tile) - 0.5);
    /* Half a texel's diagonal in radians at the centre of a map, where dw = 4 dA: how far the texel
     * that is looked up may lie off the receiver's direction, and so, times the distance, off its
     * plane. */
    float texel_angle = 2.8284271 / float(paraboloid_size);
    float tolerance = visibility_bias * (1.0 + visibility_blur) * texel_angle;
    vec3 sum = vec3(0.0);

    for (ClassVpl v : first_range) {
        vec3 d = x - v.position;
        float square = max(dot(d, d), closest);
        float cosines = max(dot(v.normal, d), 0.0) * max(-dot(n, d), 0.0);

        /* Receivers behind the horizon of the map, which members that face elsewhere can see, take
         * the depth before it. */
        vec3 c = x - v.eye;
        float eye_square = max(dot(c, c), closest);
        float reach = sqrt(eye_square);
        float w = reach + max(dot(c, v.axis), 0.0);
        float fourth = square * (square + bound);
        float reciprocal = 1.0 / (fourth * w);
        float geometry = cosines * (w * reciprocal);

        vec2 uv = vec2(dot(c, v.tangent), dot(c, v.bitangent)) * (fourth * reciprocal);
        ivec2 texel = clamp(ivec2(uv * half_size + middle), ivec2(0), ivec2(paraboloid_size - 1));
        float seen = paraboloid_distance(ivec3(texel, v.layer)).r;
        /* What the map sees hides the receiver when it lies before the receiver's tangent plane. A
         * receiver that faces away from the eye, but not from the VPL, is compared by distance. */
        float height = -dot(n, c);
        float slope = height > 0.0 ? max(height, 0.1 * reach) : reach;
        float visible = (reach - seen) * slope > tolerance * eye_square ? 0.0 : 1.0;
        sum += v.flux * (geometry * visible);
    }

    /* The second bounce is shaded without visibility, as in the paper. */
    for (Vpl v : second_range) {
        vec3 d = x - v.position;
        float square = max(dot(d, d), closest);
        float cosines = max(dot(v.normal, d), 0.0) * max(-dot(n, d), 0.0);
        sum += v.flux * (cosines / (square * (square + bound)));
    }

    /* Half floats end at 65504. */
    vec4 shaded = vec4(min(sum * (float(class_count) / PI), 60000.0), 1.0);
