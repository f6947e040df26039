/* What the map of each cluster of first-bounce VPLs shows of the scene. */
vec3 map_eye(int c)
{
    return cluster_views[c].position;
}

vec3 map_axis(int c)
{
    return cluster_views[c].normal;
}

int map_member(int c)
{
    return cluster_views[c].member;
}

void keep_draw(int k, uint index_count, uint first_index)
{
    paraboloid_draws[k].index_count = index_count;
    paraboloid_draws[k].instance_count = index_count > 0u ? 1u : 0u;
    paraboloid_draws[k].first_index = first_index;
    paraboloid_draws[k].vertex_offset = 0;
    paraboloid_draws[k].first_instance = uint(k);
}

#include "cull_map.glsl"
