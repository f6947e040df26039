/* Texels of the first-bounce maps store distance and triangle. One draw per map. */
#define MAP_SIZE paraboloid_size

int map_of(int instance)
{
    return instance;
}

#ifdef FRAGMENT
void write_texel(float reach, uint number)
{
    paraboloid_distance = vec4(reach, 0.0, 0.0, 1.0);
    paraboloid_triangle = uvec4(number, 0u, 0u, 1u);
}
#endif

#include "paraboloid_map.glsl"
