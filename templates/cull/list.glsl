/* Writes the lists, in the order of the mesh. A workgroup handles one chunk of triangles, an invocation 32 triangles for one layer. */
shared uint words[chunk_words * 64];

void main()
{
    int lane = int(gl_LocalInvocationIndex);
    int layer = lane / chunk_words;
    int chunk = int(gl_WorkGroupID.x);
    uint word = bits[chunk * chunk_words * cull_layers + lane];
    words[lane] = word;
    barrier();
    uint place = draws[layer].first_index / 3u + places[chunk * cull_layers + layer];
    for (int k = layer * chunk_words; k < lane; k++)
        place += uint(bitCount(words[k]));
    int first = chunk * chunk_triangles + 32 * (lane % chunk_words);
    word = draws[layer].index_count > 0u ? word : 0u; /* 0: the list found no room */
    for (uint at = 3u * place; word != 0u; at += 3u) {
        int corner = 3 * (first + findLSB(word));
        word &= word - 1u;
        indices[at] = scene_indices[corner];
        indices[at + 1u] = scene_indices[corner + 1];
        indices[at + 2u] = scene_indices[corner + 2];
    }
}
