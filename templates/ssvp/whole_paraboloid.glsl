/* Maps of paraboloid.glsl whose lists found no room, drawn from the whole scene. Triangle numbers
 * continue after those of all lists. */
#ifdef VERTEX
uint first_triangle(int instance)
{
    return uint(listed_triangles);
}
#endif

#include "paraboloid_texel.glsl"
