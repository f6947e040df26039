/* Prefix sums of triangle counts: the start of each list, and of each chunk within the list. Lists
 * follow each other as long as there is room; a layer whose lists find no room draws the whole
 * scene, in a separate pass. One invocation per list and slice of the chunks, then one per layer. */
shared uint sums[gl_WorkGroupSize.x]; /* slice by slice */
shared uint totals[128];

uint total_of(int layer)
{
    uint sum = 0u;
    for (int part = 0; part < parts; part++)
        sum += totals[layer * parts + part];
    return sum;
}

/* Of the chunks before this slice. */
uint earlier(int slice, int list)
{
    uint sum = 0u;
    for (int k = 0; k < slice; k++)
        sum += sums[k * lists + list];
    return sum;
}

void main()
{
    /* CPU drivers gain nothing by slices, which are read twice. */
    int slices = gl_WorkGroupSize.x > 128u ? int(gl_WorkGroupSize.x) / lists : 1;
    int lane = int(gl_LocalInvocationIndex);
    int slice = lane / lists, list = lane % lists;
    uint chunks = groups[0];
    uint share = (chunks + uint(slices) - 1u) / uint(slices);
    uint begin = uint(slice) * share, end = slice < slices ? min(begin + share, chunks) : 0u;
    uint sum = 0u;
    for (uint k = begin; k < (slices > 1 ? end : 0u); k++)
        sum += counts[k * uint(lists) + uint(list)];
    sums[lane] = sum;
    barrier();
    uint total = earlier(min(slice, slices - 1), list);
    for (uint k = begin; k < end; k++) {
        uint at = k * uint(lists) + uint(list);
        places[at] = total;
        total += counts[at];
    }
    if (slice == slices - 1)
        totals[list] = total;
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
