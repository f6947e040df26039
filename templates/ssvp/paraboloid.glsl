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

#ifdef FRAGMENT
void write_texel(vec3 point, float reach, vec3 normal, vec3 albedo)
{
    paraboloid_position = vec4(point, 1.0);
    paraboloid_distance = vec4(reach, 0.0, 0.0, 1.0);
    paraboloid_normal = vec4(normal, 0.0);
    paraboloid_albedo = vec4(albedo, 1.0);
}
#endif

#include "paraboloid_map.glsl"
