/* Words of 32 lists per triangle become words of 32 triangles per list; counts triangles. A workgroup
 * handles one chunk, an invocation 32 triangles. In a pass of its own: behind a barrier, drivers that
 * run on CPUs take turns for invocations without work, too, so that few should meet it. */

shared uint counted[chunk_words * 128]; /* per list and word: triangles */

/* The bits `part` of a, moved up by s, change places with those of b. Macros, since drivers that run on
 * CPUs keep an array in registers only if all its indices are constants. */
#define SWAP(T, a, b, s, part) \
    { \
        T moved = (a >> s ^ b) & part; \
        a ^= moved << s; \
        b ^= moved; \
    }
#define SWAP_ROWS(a, b, s, part) SWAP(uvec4, rows[a], rows[b], s, part)
#define SWAP_WITHIN(a) \
    SWAP(uvec2, rows[a].xy, rows[a].zw, 2, 0x33333333u) \
    SWAP(uvec2, rows[a].xz, rows[a].yw, 1, 0x55555555u)
#define EACH(what) what(0) what(1) what(2) what(3) what(4) what(5) what(6) what(7)
#define LOAD(a) rows[a] = load(4 * a);
#define STORE(a) \
    store(4 * a, rows[a].x); \
    store(4 * a + 1, rows[a].y); \
    store(4 * a + 2, rows[a].z); \
    store(4 * a + 3, rows[a].w);

int chunk = int(gl_WorkGroupID.x);
int word = int(gl_LocalInvocationIndex);
int from = 0; /* the first of 32 lists */

uvec4 load(int k)
{
    k += (chunk * mask_words + from / 32) * chunk_triangles + 32 * word;
    return uvec4(masks[k], masks[k + 1], masks[k + 2], masks[k + 3]);
}

void store(int k, uint row)
{
    int slot = (from + k) * chunk_words + word;
    if (from + k >= lists)
        return;
    bits[chunk * chunk_words * lists + slot] = row;
    counted[slot] = uint(bitCount(row));
}

/* Transposes bits: Warren, Hacker's Delight, 7-3. */
void main()
{
    for (; from < lists; from += 32) {
        uvec4 rows[8];
        EACH(LOAD)
        SWAP_ROWS(0, 4, 16, 0x0000ffffu)
        SWAP_ROWS(1, 5, 16, 0x0000ffffu)
        SWAP_ROWS(2, 6, 16, 0x0000ffffu)
        SWAP_ROWS(3, 7, 16, 0x0000ffffu)
        SWAP_ROWS(0, 2, 8, 0x00ff00ffu)
        SWAP_ROWS(1, 3, 8, 0x00ff00ffu)
        SWAP_ROWS(4, 6, 8, 0x00ff00ffu)
        SWAP_ROWS(5, 7, 8, 0x00ff00ffu)
        SWAP_ROWS(0, 1, 4, 0x0f0f0f0fu)
        SWAP_ROWS(2, 3, 4, 0x0f0f0f0fu)
        SWAP_ROWS(4, 5, 4, 0x0f0f0f0fu)
        SWAP_ROWS(6, 7, 4, 0x0f0f0f0fu)
        EACH(SWAP_WITHIN)
        EACH(STORE)
    }
    barrier();
    for (int list = word; list < lists; list += chunk_words) {
        uint count = 0u;
        for (int k = 0; k < chunk_words; k++)
            count += counted[list * chunk_words + k];
        counts[chunk * lists + list] = count;
    }
}
