/* One axis of the edge-aware filter over irradiance. A tent, denoise_radius tiles wide on either
 * side, weights all interleave classes equally, so it removes the pattern of the tile. Neighbours
 * beyond a discontinuity have no weight: other normals, or positions off the tangent plane.
 * Includers define SOURCE, the function that reads the image. `own`: light of p itself. */
#include "estimate.glsl"

vec4 filter_axis(ivec2 p, vec3 own, ivec2 size, ivec2 axis, int tile_length)
{
    vec4 centre = gbuffer_position(p);
    vec3 n = gbuffer_normal(p).xyz;
    int radius = max(denoise_radius * tile_length, 1);
    int first = axis.x != 0 ? p.x : p.y;
    int last = (axis.x != 0 ? size.x : size.y) - 1 - first;
    float inverse_depth = reciprocal_close(denoise_plane * max(centre.w, 1e-12));
    float inverse_normal = reciprocal_close(1.0 - denoise_normal);
    float weights = centre.w > 0.0 ? float(radius) : 0.0;
    vec3 sum = own * weights;
    for (int i = max(1 - radius, -first); i <= min(radius - 1, last); i++) {
        ivec2 q = p + axis * i;
        vec4 x = gbuffer_position(q);
        float off_plane = abs(dot(n, x.xyz - centre.xyz)) * inverse_depth;
        float alike = (dot(n, gbuffer_normal(q).xyz) - denoise_normal) * inverse_normal;
        float weight = approximate_clamp(alike, 1.0) * approximate_clamp(2.0 - off_plane, 1.0);
        weight *= x.w > 0.0 && i != 0 ? float(radius - abs(i)) : 0.0;
        sum += SOURCE(q).rgb * weight;
        weights += weight;
    }
    return vec4(weights > 0.0 ? sum * reciprocal_close(weights) : vec3(0.0), 1.0);
}
