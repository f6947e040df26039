/* The maps that tell what a cluster of second-bounce VPLs sees. */
const int MAP_SIZE = second_map_size;

vec3 map_eye(int c)
{
    return second_views[c].position;
}

vec3 map_tangent(int c)
{
    return second_views[c].tangent;
}

vec3 map_bitangent(int c)
{
    return second_views[c].bitangent;
}

vec3 map_axis(int c)
{
    return second_views[c].normal;
}

int map_member(int c)
{
    return second_views[c].member;
}

int map_of(int instance)
{
    return instance / map_draws; /* an instance, a draw */
}

uint first_triangle(int instance)
{
    return 0u;
}

#ifdef FRAGMENT
void write_texel(float reach, uint number)
{
    second_distance = vec4(reach, 0.0, 0.0, 1.0);
}
#endif

#include "paraboloid_map.glsl"
