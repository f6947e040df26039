/* The maps that second-bounce VPLs are sampled from, and that tell what a cluster of first-bounce VPLs
 * sees. */
const int MAP_SIZE = paraboloid_size;

#ifdef VERTEX
#include "map_draws.glsl"
#endif

#ifdef FRAGMENT
void write_texel(float reach, uint number)
{
    paraboloid_distance = vec4(reach, 0.0, 0.0, 1.0);
    paraboloid_triangle = uvec4(number, 0u, 0u, 1u);
}
#endif

#include "paraboloid_map.glsl"
