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

#ifdef FRAGMENT
void write_texel(vec3 point, float reach, vec3 normal, vec3 albedo)
{
    map_distance = vec4(reach, 0.0, 0.0, 1.0);
}
#endif

#include "../ssvp/paraboloid_map.glsl"
