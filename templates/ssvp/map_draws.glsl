/* What an instance of the draws that cull_maps.glsl makes is: every draw is one, map after map. The pass
 * calls them `draws`. */
int map_of(int instance)
{
    return instance / map_draws;
}

uint first_triangle(int instance)
{
    return draws[instance].first_index / 3u;
}
