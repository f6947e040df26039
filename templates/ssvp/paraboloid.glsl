/* The maps that second-bounce VPLs are sampled from, and that tell what a cluster of first-bounce VPLs
 * sees, from the lists of what each draws. */
#ifdef VERTEX
uint first_triangle(int instance)
{
    return paraboloid_draws[instance].first_index / 3u;
}
#endif

#include "paraboloid_texel.glsl"
