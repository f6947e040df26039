/* Lists of triangles: which lists have a triangle, and how many each has of a chunk. A workgroup
 * handles one chunk of consecutive triangles, an invocation one triangle. Includers have
 * main(). */

shared uint masks[chunk_triangles]; /* per triangle: which of 32 lists have it, one bit each */
shared uint words[chunk_words * 128];

vec3 corner(uint k)
{
    SceneVertex v = scene_vertices[scene_indices[k]];
    return vec3(v.px, v.py, v.pz);
}

/* Transposes bits: from one word of 32 lists per triangle to one word of 32 triangles per list. Few
 * invocations read each mask once: drivers that run on CPUs pay for a read of shared memory per
 * vector of invocations. */
void turn_masks(int word, int from)
{
    uint mask[32];
    for (int k = 0; k < 32; k++)
        mask[k] = masks[32 * word + k];
    for (int list = from; list < min(from + 32, lists); list++) {
        uint row = 0u;
        for (int k = 0; k < 32; k++)
            row |= (mask[k] >> (list - from) & 1u) << k;
        words[list * chunk_words + word] = row;
    }
}

/* The triangle of this invocation; false: there is none, and the corners are of another one. */
bool triangle_of(out vec3 a, out vec3 b, out vec3 c)
{
    uint triangle = gl_WorkGroupID.x * uint(chunk_triangles) + gl_LocalInvocationIndex;
    uint first = 3u * min(triangle, frame.triangle_count - 1u);
    a = corner(first);
    b = corner(first + 1u);
    c = corner(first + 2u);
    return triangle < frame.triangle_count;
}

/* mask: a bit for each list that has the triangle. All invocations of a workgroup call it. */
void store_lists(uvec4 mask)
{
    int lane = int(gl_LocalInvocationIndex);
    for (int from = 0; from < lists; from += 32) {
        barrier();
        masks[lane] = mask[from / 32];
        barrier();
        for (int word = lane; word < chunk_words; word += chunk_triangles)
            turn_masks(word, from);
    }
    barrier();
    int words_first = int(gl_WorkGroupID.x) * chunk_words * lists;
    for (int k = lane; k < chunk_words * lists; k += chunk_triangles)
        bits[words_first + k] = words[k];
    for (int list = lane; list < lists; list += chunk_triangles) {
        uint count = 0u;
        for (int k = 0; k < chunk_words; k++)
            count += uint(bitCount(words[list * chunk_words + k]));
        counts[int(gl_WorkGroupID.x) * lists + list] = count;
    }
}
