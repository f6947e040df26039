/* Words of 32 lists per triangle become words of 32 triangles per list; counts triangles. A workgroup
 * handles one chunk. On a GPU, an invocation handles 32 triangles and one list of 32. On a CPU, 32
 * triangles and all lists; in a pass of its own: behind a barrier, drivers that run on CPUs take turns
 * for invocations without work, too, so that few should meet it. */

shared uint counted[chunk_words * 128]; /* per list and word: triangles */

/* Macros, since drivers that run on CPUs keep an array in registers only if all its indices are
 * constants. */
#define EACH(what) what(0) what(1) what(2) what(3) what(4) what(5) what(6) what(7)
#define LOAD(k) \
    four[k] = uvec4(masks[at + 4 * k], masks[at + 4 * k + 1], masks[at + 4 * k + 2], \
                    masks[at + 4 * k + 3]);
#define TAKE(k) taken |= (four[k] >> bit & 1u) << uvec4(4 * k, 4 * k + 1, 4 * k + 2, 4 * k + 3);

/* The bits of 32 triangles for the list from + bit. */
void store_row(uvec4 four[8], int from, int bit, int word)
{
    uvec4 taken = uvec4(0u);
    EACH(TAKE)
    uint row = taken.x | taken.y | taken.z | taken.w;
    int slot = (from + bit) * chunk_words + word;
    bits[int(gl_WorkGroupID.x) * chunk_words * lists + slot] = row;
    counted[slot] = uint(bitCount(row));
}

void main()
{
    int chunk = int(gl_WorkGroupID.x);
    int lane = int(gl_LocalInvocationIndex);
    int lanes = int(gl_WorkGroupSize.x);
    int word = lane % chunk_words;
    for (int from = 0; from < lists; from += 32) {
        int at = (chunk * mask_words + from / 32) * chunk_triangles + 32 * word;
        int here = min(lists - from, 32);
        uvec4 four[8];
        EACH(LOAD)
        if (lanes < 32 * chunk_words)
            for (int bit = 0; bit < here; bit++)
                store_row(four, from, bit, word);
        else if (lane / chunk_words < here)
            store_row(four, from, lane / chunk_words, word);
    }
    barrier();
    for (int list = lane; list < lists; list += lanes) {
        uint count = 0u;
        for (int k = 0; k < chunk_words; k++)
            count += counted[list * chunk_words + k];
        counts[chunk * lists + list] = count;
    }
}
