/* Writes the lists, in the order of the mesh. A workgroup handles one chunk of triangles, an
 * invocation 32 triangles for one list, or for two. */
shared uint words[chunk_words * 128];

void main()
{
    int step_of_slots = int(gl_WorkGroupSize.x);
    int chunk = int(gl_WorkGroupID.x);
    for (int slot = int(gl_LocalInvocationIndex); slot < chunk_words * lists; slot += step_of_slots)
        words[slot] = bits[chunk * chunk_words * lists + slot];
    barrier();
    for (int slot = int(gl_LocalInvocationIndex); slot < chunk_words * lists; slot += step_of_slots) {
        int list = slot / chunk_words;
        uint place = draws[list].first_index / 3u + places[chunk * lists + list];
        for (int k = list * chunk_words; k < slot; k++)
            place += uint(bitCount(words[k]));
        int first = chunk * chunk_triangles + 32 * (slot % chunk_words);
        uint word = draws[list].index_count > 0u ? words[slot] : 0u; /* 0: the list found no room */
        for (uint at = 3u * place; word != 0u; at += 3u) {
            int corner = 3 * (first + findLSB(word));
            word &= word - 1u;
            indices[at] = scene_indices[corner];
            indices[at + 1u] = scene_indices[corner + 1];
            indices[at + 2u] = scene_indices[corner + 2];
        }
    }
}
