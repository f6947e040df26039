/* The maps that tell what a cluster of second-bounce VPLs sees. */
const int MAP_SIZE = second_map_size;

#ifdef VERTEX
#include "map_draws.glsl"
#endif

#ifdef FRAGMENT
void write_texel(float reach, uint number)
{
    second_distance = vec4(reach, 0.0, 0.0, 1.0);
}
#endif

#include "paraboloid_map.glsl"
