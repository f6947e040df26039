/* What the map of each cluster of second-bounce VPLs shows of the scene. */
vec3 map_eye(int c)
{
    return second_views[c].position;
}

vec3 map_axis(int c)
{
    return second_views[c].normal;
}

int map_member(int c)
{
    return second_views[c].member;
}

void keep_draw(int k, uint index_count, uint first_index)
{
    second_draws[k].index_count = index_count;
    second_draws[k].instance_count = index_count > 0u ? 1u : 0u;
    second_draws[k].first_index = first_index;
    second_draws[k].vertex_offset = 0;
    second_draws[k].first_instance = uint(k);
}

#include "cull_map.glsl"
