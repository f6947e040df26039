/* Visibility maps of clusters of second-bounce VPLs. */
#define MAP_SIZE second_map_size

int map_of(int instance)
{
    return instance;
}

uint first_triangle(int instance)
{
    return 0u; /* unused: these maps store no triangle */
}

#ifdef FRAGMENT
void write_texel(float reach, uint number)
{
    second_distance = vec4(reach, 0.0, 0.0, 1.0);
}
#endif

#include "paraboloid_map.glsl"
