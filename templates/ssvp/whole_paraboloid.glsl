/* The maps of paraboloid.glsl whose lists found no room, from the whole scene: its triangles are numbered
 * behind those of all lists. */
#ifdef VERTEX
uint first_triangle(int instance)
{
    return uint(listed_triangles);
}
#endif

#include "paraboloid_texel.glsl"
