/* Words of 32 lists per triangle become words of 32 triangles per list; counts triangles. A workgroup
 * handles one chunk, an invocation 32 triangles. In a pass of its own, without barriers: behind a
 * barrier, drivers that run on CPUs take turns for invocations without work, too. */

const uint HALVES = 0x0000ffffu;
const uint BYTES = 0x00ff00ffu;
const uint NIBBLES = 0x0f0f0f0fu;
const uint PAIRS = 0x33333333u;
const uint SINGLE = 0x55555555u;

/* Bits `part` of rows[a], moved up by s, change places with those of rows[a + s]. Macros, since drivers
 * that run on CPUs keep an array in registers only if all its indices are constants. */
#define SWAP(a, s, part) \
    { \
        uint moved = (rows[a] >> s ^ rows[a + s]) & part; \
        rows[a] ^= moved << s; \
        rows[a + s] ^= moved; \
    }
#define SWAP_2(a, s, part) SWAP(a, s, part) SWAP(a + 1, s, part)
#define SWAP_4(a, s, part) SWAP_2(a, s, part) SWAP_2(a + 2, s, part)
#define SWAP_8(a, s, part) SWAP_4(a, s, part) SWAP_4(a + 4, s, part)
#define SWAP_16(a, s, part) SWAP_8(a, s, part) SWAP_8(a + 8, s, part)
#define EACH_4(what, a) what(a) what(a + 1) what(a + 2) what(a + 3)
#define EACH_16(what, a) \
    EACH_4(what, a) EACH_4(what, a + 4) EACH_4(what, a + 8) EACH_4(what, a + 12)
#define LOAD(k) rows[k] = masks[first + k];
#define STORE(k) \
    if (from + k < lists) { \
        bits[(chunk * lists + from + k) * chunk_words + word] = rows[k]; \
        atomicAdd(counts[chunk * lists + from + k], uint(bitCount(rows[k]))); \
    }

/* Transposes bits (Warren, Hacker's Delight, 7-3): from one word of 32 lists per triangle to one word
 * of 32 triangles per list. */
void turn_masks(int chunk, int word, int from)
{
    int first = (chunk * mask_words + from / 32) * chunk_triangles + 32 * word;
    uint rows[32];
    EACH_16(LOAD, 0)
    EACH_16(LOAD, 16)
    SWAP_16(0, 16, HALVES)
    SWAP_8(0, 8, BYTES) SWAP_8(16, 8, BYTES)
    SWAP_4(0, 4, NIBBLES) SWAP_4(8, 4, NIBBLES) SWAP_4(16, 4, NIBBLES) SWAP_4(24, 4, NIBBLES)
    SWAP_2(0, 2, PAIRS) SWAP_2(4, 2, PAIRS) SWAP_2(8, 2, PAIRS) SWAP_2(12, 2, PAIRS)
    SWAP_2(16, 2, PAIRS) SWAP_2(20, 2, PAIRS) SWAP_2(24, 2, PAIRS) SWAP_2(28, 2, PAIRS)
    SWAP(0, 1, SINGLE) SWAP(2, 1, SINGLE) SWAP(4, 1, SINGLE) SWAP(6, 1, SINGLE)
    SWAP(8, 1, SINGLE) SWAP(10, 1, SINGLE) SWAP(12, 1, SINGLE) SWAP(14, 1, SINGLE)
    SWAP(16, 1, SINGLE) SWAP(18, 1, SINGLE) SWAP(20, 1, SINGLE) SWAP(22, 1, SINGLE)
    SWAP(24, 1, SINGLE) SWAP(26, 1, SINGLE) SWAP(28, 1, SINGLE) SWAP(30, 1, SINGLE)
    EACH_16(STORE, 0)
    EACH_16(STORE, 16)
}

void main()
{
    for (int from = 0; from < lists; from += 32)
        turn_masks(int(gl_WorkGroupID.x), int(gl_LocalInvocationIndex), from);
}
