/* Numbers of the triangles in this frame's maps, for `sample_maps`, which looks up all maps that are kept. */
#include "kept.glsl"

void main()
{
    ivec3 at = invocation();
    if (any(greaterThanEqual(at.xy, drawn_size())))
        return;
    int layer = kept_layer(at.z, clusters, first_kept);
    kept_numbers_store(ivec3(at.xy, layer), uvec4(drawn(at).x, 0u, 0u, 0u));
}
