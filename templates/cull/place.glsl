/* Prefix sums of triangle counts: the start of each list, and of each chunk within the list. Lists
 * follow each other as long as there is room; a layer whose lists find no room draws the whole
 * scene, in a separate pass. One invocation per list, then one per layer. */
shared uint totals[128];

uint total_of(int layer)
{
    uint sum = 0u;
    for (int part = 0; part < parts; part++)
        sum += totals[layer * parts + part];
    return sum;
}

void main()
{
    int lane = int(gl_LocalInvocationIndex);
    uint chunks = groups[0];
    uint total = 0u;
    for (uint k = 0u; k < (lane < lists ? chunks : 0u); k++) {
        uint at = k * uint(lists) + uint(lane);
        places[at] = total;
        total += counts[at];
    }
    totals[lane] = total;
    barrier();
    if (lane >= cull_layers)
        return;
    uint first = 0u;
    for (int k = 0; k < lane; k++)
        first += first + total_of(k) <= uint(listed) ? total_of(k) : 0u;
    bool fits = chunks > 0u && first + total_of(lane) <= uint(listed);
    for (int part = 0; part < parts; part++) {
        int list = lane * parts + part;
        draws[list].index_count = fits ? 3u * totals[list] : 0u;
        draws[list].instance_count = !fits || totals[list] == 0u ? 0u : part == 0 ? 1u : uint(cull_again);
        draws[list].first_index = fits ? 3u * first : 0u;
        draws[list].vertex_offset = 0;
        draws[list].first_instance = uint(lane * (1 + cull_again) + part);
        first += totals[list];
    }
    bool whole = !fits && frame.triangle_count > 0u;
    whole_draws[lane].index_count = whole ? 3u * frame.triangle_count : 0u;
    whole_draws[lane].instance_count = whole ? uint(max(cull_again, 1)) : 0u;
    whole_draws[lane].first_index = 0u;
    whole_draws[lane].vertex_offset = 0;
    whole_draws[lane].first_instance = uint(lane * (1 + cull_again) + parts - 1);
}
