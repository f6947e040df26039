/* Writes the lists, in the order of the mesh. A workgroup handles one chunk of triangles, an
 * invocation 32 triangles for one list, or for more. */

void write_list(int slot)
{
    int chunk = int(gl_WorkGroupID.x);
    int list = slot / chunk_words;
    int own = slot % chunk_words;
    int begin = (chunk * lists + list) * chunk_words;
    uint place = draws[list].first_index / 3u + places[chunk * lists + list];
    for (int k = 0; k < chunk_words - 1; k++) /* all reads at once: a GPU waits for one */
        place += k < own ? uint(bitCount(bits[begin + k])) : 0u;
    int first = chunk * chunk_triangles + 32 * own;
    uint word = bits[begin + own];
    if (draws[list].index_count == 0u) /* the list found no room */
        word = 0u;
    for (uint at = 3u * place; word != 0u; at += 3u) {
        int corner = 3 * (first + findLSB(word));
        word &= word - 1u;
        indices[at] = scene_indices[corner];
        indices[at + 1u] = scene_indices[corner + 1];
        indices[at + 2u] = scene_indices[corner + 2];
    }
}

void main()
{
    int lane = int(gl_LocalInvocationIndex);
    int lanes = int(gl_WorkGroupSize.x);
    if (lanes < 32 * chunk_words) /* fewer lists than 32: one for each invocation */
        write_list(lane);
    else
        for (int slot = lane; slot < chunk_words * lists; slot += lanes)
            write_list(slot);
}
