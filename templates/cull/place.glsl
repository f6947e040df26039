/* Prefix sums of triangle counts: the start of each layer's list, and of each chunk within the list.
 * Lists follow each other as long as there is room; a layer whose list finds no room draws the whole
 * scene, in a separate pass. One invocation per layer. */
shared uint totals[64];

void main()
{
    int layer = int(gl_LocalInvocationIndex);
    uint chunks = groups[0];
    uint total = 0u;
    for (uint k = 0u; k < (layer < cull_layers ? chunks : 0u); k++) {
        uint at = k * uint(cull_layers) + uint(layer);
        places[at] = total;
        total += counts[at];
    }
    totals[layer] = total;
    barrier();
    if (layer >= cull_layers)
        return;
    uint first = 0u;
    for (int k = 0; k < layer; k++)
        first += first + totals[k] <= uint(listed) ? totals[k] : 0u;
    bool fits = chunks > 0u && first + total <= uint(listed);
    bool empty = frame.triangle_count == 0u;
    draws[layer].index_count = fits ? 3u * total : 0u;
    draws[layer].instance_count = fits && total > 0u ? 1u : 0u;
    draws[layer].first_index = fits ? 3u * first : 0u;
    draws[layer].vertex_offset = 0;
    draws[layer].first_instance = uint(layer);
    whole_draws[layer].index_count = fits || empty ? 0u : 3u * frame.triangle_count;
    whole_draws[layer].instance_count = fits || empty ? 0u : 1u;
    whole_draws[layer].first_index = 0u;
    whole_draws[layer].vertex_offset = 0;
    whole_draws[layer].first_instance = uint(layer);
}
