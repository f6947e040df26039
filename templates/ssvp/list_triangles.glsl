/* Writes each map's list of triangles in the order of the mesh, which decides between triangles of
 * equal depth. A workgroup handles one chunk of triangles, an invocation 32 triangles for one map.
 * The pass binds the draws of lists as `draws`. */
shared uint words[chunk_words * maps_limit];

void main()
{
    int lane = int(gl_LocalInvocationIndex);
    int map = lane / chunk_words;
    int chunk = int(gl_WorkGroupID.x);
    uint word = triangle_bits[chunk * chunk_words * draws_count + lane];
    words[lane] = word;
    barrier();
    uint place = draws[map].first_index / 3u + chunk_places[chunk * draws_count + map];
    for (int k = map * chunk_words; k < lane; k++)
        place += uint(bitCount(words[k]));
    int first = chunk * chunk_triangles + 32 * (lane % chunk_words);
    word = draws[map].index_count > 0u ? word : 0u; /* 0: the list found no room */
    for (uint at = 3u * place; word != 0u; at += 3u) {
        int corner = 3 * (first + findLSB(word));
        word &= word - 1u;
        map_indices[at] = scene_indices[corner];
        map_indices[at + 1u] = scene_indices[corner + 1];
        map_indices[at + 2u] = scene_indices[corner + 2];
    }
}
