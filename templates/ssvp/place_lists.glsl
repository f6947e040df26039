/* Prefix sums of triangle counts: the start of each map's list, and of each chunk within the list.
 * Lists follow each other as long as there is room; a map whose list finds no room draws the whole
 * scene, in a separate pass. One invocation per map. The pass binds the draws of lists as `draws`,
 * those of the whole scene as `whole_draws`. */
shared uint totals[64];

void main()
{
    int map = int(gl_LocalInvocationIndex);
    uint chunks = cull_groups[0];
    uint total = 0u;
    for (uint k = 0u; k < (map < views_count ? chunks : 0u); k++) {
        uint at = k * uint(views_count) + uint(map);
        chunk_places[at] = total;
        total += chunk_counts[at];
    }
    totals[map] = total;
    barrier();
    if (map >= views_count)
        return;
    uint first = 0u;
    for (int k = 0; k < map; k++)
        first += first + totals[k] <= uint(listed_triangles) ? totals[k] : 0u;
    bool fits = chunks > 0u && first + total <= uint(listed_triangles);
    bool empty = views[map].member < 0 || frame.triangle_count == 0u;
    draws[map].index_count = fits ? 3u * total : 0u;
    draws[map].instance_count = fits && total > 0u ? 1u : 0u;
    draws[map].first_index = fits ? 3u * first : 0u;
    draws[map].vertex_offset = 0;
    draws[map].first_instance = uint(map);
    whole_draws[map].index_count = fits || empty ? 0u : 3u * frame.triangle_count;
    whole_draws[map].instance_count = fits || empty ? 0u : 1u;
    whole_draws[map].first_index = 0u;
    whole_draws[map].vertex_offset = 0;
    whole_draws[map].first_instance = uint(map);
}
