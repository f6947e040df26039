/* The maps that tell what each VPL sees. */
const int MAP_SIZE = paraboloid_size;

vec3 map_eye(int c)
{
    return views[c].position;
}

vec3 map_tangent(int c)
{
    return views[c].tangent;
}

vec3 map_bitangent(int c)
{
    return views[c].bitangent;
}

vec3 map_axis(int c)
{
    return views[c].normal;
}

int map_member(int c)
{
    return views[c].member;
}

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
