/* Visibility maps, one per VPL. */
#define MAP_SIZE paraboloid_size

int map_of(int instance)
{
    return instance;
}

uint first_triangle(int instance)
{
    return 0u;
}

#ifdef FRAGMENT
void write_texel(float reach, uint number)
{
    map_distance = vec4(reach, 0.0, 0.0, 1.0);
}
#endif

#include "../ssvp/paraboloid_map.glsl"
