/* Writes the lists, in the order of the mesh. A workgroup handles one chunk of triangles, an
 * invocation 32 triangles for one list, or for more. */
void main()
{
    int chunk = int(gl_WorkGroupID.x);
    int slots = chunk_words * lists;
    for (int slot = int(gl_LocalInvocationIndex); slot < slots; slot += int(gl_WorkGroupSize.x)) {
        int list = slot / chunk_words;
        uint place = draws[list].first_index / 3u + places[chunk * lists + list];
        for (int k = list * chunk_words; k < slot; k++)
            place += uint(bitCount(bits[chunk * slots + k]));
        int first = chunk * chunk_triangles + 32 * (slot % chunk_words);
        uint word = bits[chunk * slots + slot];
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
}
