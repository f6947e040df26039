/* Decides which maps draw a triangle, and counts the triangles per chunk and map. A map omits
 * triangles that cannot be visible in it: those behind the plane through its eye, and those that
 * cover no texel centre, which are most others in finely meshed scenes (Wihlidal, GDC 2016).
 *
 * Corners are projected to texels as in paraboloid_map.glsl. Rasterizers snap corners to a grid, up
 * to 1/512 of a texel away with the usual 8 bits, and arithmetic rounds. So triangles closer than
 * SNAP to a centre stay. Triangles across the horizon stay, too: their projection has no bounds. No
 * branches: drivers that run on CPUs then keep all values in registers.
 *
 * A workgroup handles one chunk of consecutive triangles, an invocation one triangle. */

shared uint masks[chunk_triangles]; /* per triangle: which of 32 maps draw it, one bit each */
shared uint words[chunk_words * maps_limit];

const float SNAP = 1.0 / 256.0;
const int ROWS = 4; /* a triangle across more rows nearly always covers a centre */

vec3 corner(uint k)
{
    SceneVertex v = scene_vertices[scene_indices[k]];
    return vec3(v.px, v.py, v.pz);
}

/* x, y: texels; z: height over the eye's plane. */
vec3 place(vec3 d, vec3 tangent, vec3 bitangent, vec3 normal)
{
    vec3 local = vec3(dot(d, tangent), dot(d, bitangent), dot(d, normal));
    float scale = 0.5 * float(paraboloid_size) / (length(d) + local.z);
    return vec3(local.xy * scale + 0.5 * float(paraboloid_size), local.z);
}

/* Whether the triangle covers one of the texel centres (0, 0) to `last`, in at most ROWS rows.
 * `turn`: 1 if wound from x to y, else -1. In each row, every edge bounds the inside along x. */
bool covers_centre(vec2 a, vec2 b, vec2 c, float turn, vec2 last)
{
    vec3 x = vec3(a.y - b.y, b.y - c.y, c.y - a.y) * turn; /* inward normal of each edge */
    vec3 y = vec3(b.x - a.x, c.x - b.x, a.x - c.x) * turn;
    vec3 inner = x * vec3(a.x, b.x, c.x) + y * vec3(a.y, b.y, c.y) - SNAP * (abs(x) + abs(y));
    x.x = x.x == 0.0 ? 1e-20 : x.x; /* edge along the rows: its bound lies far outside the row */
    x.y = x.y == 0.0 ? 1e-20 : x.y;
    x.z = x.z == 0.0 ? 1e-20 : x.z;
    vec3 place = inner / x;
    vec3 slope = y / x;
    bool covers = false;
    for (int row = 0; row < ROWS; row++) {
        vec3 edge = place - slope * float(row);
        float from = max(max(x.x > 0.0 ? edge.x : 0.0, x.y > 0.0 ? edge.y : 0.0),
                         max(x.z > 0.0 ? edge.z : 0.0, 0.0));
        float to = min(min(x.x > 0.0 ? last.x : edge.x, x.y > 0.0 ? last.x : edge.y),
                       min(x.z > 0.0 ? last.x : edge.z, last.x));
        covers = covers || (float(row) <= last.y && ceil(from) <= to);
    }
    return covers;
}

bool draws_triangle(vec3 a, vec3 b, vec3 c)
{
    float slack = 1e-5 * frame.scene_radius;
    bool behind = max(max(a.z, b.z), c.z) < -slack;
    bool before = min(min(a.z, b.z), c.z) > slack;
    vec2 first = ceil(min(min(a.xy, b.xy), c.xy) - (0.5 + SNAP)) + 0.5;
    vec2 last = floor(max(max(a.xy, b.xy), c.xy) - (0.5 - SNAP)) + 0.5 - first;
    bool between = last.x < 0.0 || last.y < 0.0;
    /* Rows run along the longer side. */
    bool tall = last.y > last.x;
    vec2 p = a.xy - first;
    vec2 q = b.xy - first;
    vec2 r = c.xy - first;
    p = tall ? p.yx : p;
    q = tall ? q.yx : q;
    r = tall ? r.yx : r;
    last = tall ? last.yx : last;
    /* Twice the area. The winding is uncertain if the area is within its rounding error, which
     * grows with the length of the triangle. */
    float area = (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
    bool few = abs(area) > 1e-3 * max(last.x, 1.0) && last.y < float(ROWS);
    bool beside = few && !covers_centre(p, q, r, area > 0.0 ? 1.0 : -1.0, last);
    return !behind && !(before && (between || beside));
}

/* Transposes bits: from one word of 32 maps per triangle to one word of 32 triangles per map. Few
 * invocations read each mask once: drivers that run on CPUs pay for a read of shared memory per
 * vector of invocations. */
void turn_masks(int word, int from)
{
    uint mask[32];
    for (int k = 0; k < 32; k++)
        mask[k] = masks[32 * word + k];
    for (int map = from; map < min(from + 32, views_count); map++) {
        uint bits = 0u;
        for (int k = 0; k < 32; k++)
            bits |= (mask[k] >> (map - from) & 1u) << k;
        words[map * chunk_words + word] = bits;
    }
}

void main()
{
    int lane = int(gl_LocalInvocationIndex);
    uint triangle = gl_WorkGroupID.x * uint(chunk_triangles) + uint(lane);
    bool real = triangle < frame.triangle_count;
    uint first = 3u * min(triangle, frame.triangle_count - 1u);
    vec3 a = corner(first);
    vec3 b = corner(first + 1u);
    vec3 c = corner(first + 2u);
    uvec2 mask = uvec2(0u);
    int map = 0;
    for (ClusterView v : eyes) {
        bool drawn = draws_triangle(place(a - v.position, v.tangent, v.bitangent, v.normal),
                                    place(b - v.position, v.tangent, v.bitangent, v.normal),
                                    place(c - v.position, v.tangent, v.bitangent, v.normal));
        uint bit = real && drawn && v.member >= 0 ? 1u : 0u;
        mask |= map < 32 ? uvec2(bit << map, 0u) : uvec2(0u, bit << (map - 32));
        map++;
    }
    for (int from = 0; from < views_count; from += 32) {
        barrier();
        masks[lane] = from == 0 ? mask.x : mask.y;
        barrier();
        for (int word = lane; word < chunk_words; word += chunk_triangles)
            turn_masks(word, from);
    }
    barrier();
    int words_first = int(gl_WorkGroupID.x) * chunk_words * views_count;
    for (int k = lane; k < chunk_words * views_count; k += chunk_triangles)
        triangle_bits[words_first + k] = words[k];
    for (int map = lane; map < views_count; map += chunk_triangles) {
        uint count = 0u;
        for (int k = 0; k < chunk_words; k++)
            count += uint(bitCount(words[map * chunk_words + k]));
        chunk_counts[int(gl_WorkGroupID.x) * views_count + map] = count;
    }
}
