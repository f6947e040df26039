/* The maps that second-bounce VPLs are sampled from, and that tell what a cluster of first-bounce VPLs
 * sees. */
const int MAP_SIZE = paraboloid_size;

vec3 map_eye(int c)
{
    return cluster_views[c].position;
}

vec3 map_tangent(int c)
{
    return cluster_views[c].tangent;
}

vec3 map_bitangent(int c)
{
    return cluster_views[c].bitangent;
}

vec3 map_axis(int c)
{
    return cluster_views[c].normal;
}

int map_member(int c)
{
    return cluster_views[c].member;
}

int map_of(int instance)
{
    return instance / map_draws; /* an instance, a draw */
}

uint first_triangle(int instance)
{
    return paraboloid_draws[instance].first_index / 3u;
}

#ifdef FRAGMENT
void write_texel(float reach, uint number)
{
    paraboloid_distance = vec4(reach, 0.0, 0.0, 1.0);
    paraboloid_triangle = uvec4(number, 0u, 0u, 1u);
}
#endif

#include "paraboloid_map.glsl"
