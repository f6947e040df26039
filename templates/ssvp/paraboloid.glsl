/* Paraboloid maps of first-bounce clusters. They give the visibility of the clusters and the samples
 * for second-bounce VPLs. */
#ifdef VERTEX
uint first_triangle(int instance)
{
    return whole == 1 ? uint(paraboloid_listed) : paraboloid_draws[instance].first_index / 3u;
}
#endif

#include "paraboloid_texel.glsl"
