/* Measures this frame's maps, and lets them take the place of the oldest that are kept, with their
 * eyes. So while surfaces stand still, VPLs find an eye nearby among many, and each frame draws a few
 * maps only (Laine et al., "Incremental Instant Radiosity for Real-Time Indirect Illumination", 2007).
 * Until light moves far the eyes of earlier frames remain of use: a map shows surfaces, not light. */
#include "kept.glsl"
#include "measured.glsl"

void main()
{
    ivec3 at = invocation();
    if (any(greaterThanEqual(at.xy, drawn_size())))
        return;
    int layer = kept_layer(at.z, maps, kept);
    reach_store(ivec3(at.xy, layer), vec4(measured_reach(at, drawn(at).x)));
    if (at.xy != ivec2(0))
        return;
    eyes[layer].used = views[at.z].member >= 0 ? 1 : 0;
    eyes[layer].position = views[at.z].position;
    eyes[layer].tangent = views[at.z].tangent;
    eyes[layer].bitangent = views[at.z].bitangent;
    eyes[layer].normal = views[at.z].normal;
}
