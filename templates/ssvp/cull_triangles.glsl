/* Which maps draw a triangle, and how many of a chunk each map draws. A map leaves out what cannot show
 * in it: triangles wholly behind the plane through its eye, and those that cover no texel's centre,
 * which in a scene of fine meshes are most of the rest (Wihlidal, GDC 2016).
 *
 * Corners go to texels as paraboloid_map.glsl has it. Rasterizers move them from there to the nearest
 * point of a grid, up to 1/512 of a texel away with the 8 bits that drivers have, and arithmetic rounds:
 * whatever comes nearer to a centre than SNAP stays. So does what crosses the horizon, where the
 * projection of a corner has no bounds. No branch: drivers that run on CPUs then keep all in registers.
 *
 * A workgroup has a chunk of triangles that follow each other, an invocation a triangle. */

shared uint masks[chunk_triangles]; /* which of 32 maps draw a triangle, a bit each */
shared uint words[chunk_words * views_count];

const float SNAP = 1.0 / 256.0;

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

/* Whether all centres from `first` to `last` lie beyond the edge from a to b, seen from the third
 * corner, on whose side `turn` says where inside is. */
bool beyond(vec2 a, vec2 b, float turn, vec2 first, vec2 last)
{
    vec2 inward = vec2(a.y - b.y, b.x - a.x) * turn;
    vec2 nearest = vec2(inward.x > 0.0 ? last.x : first.x, inward.y > 0.0 ? last.y : first.y);
    return dot(inward, nearest - a) < -SNAP * (abs(inward.x) + abs(inward.y));
}

bool draws_triangle(vec3 a, vec3 b, vec3 c)
{
    float slack = 1e-5 * frame.scene_radius;
    bool behind = max(max(a.z, b.z), c.z) < -slack;
    bool before = min(min(a.z, b.z), c.z) > slack;
    vec2 low = min(min(a.xy, b.xy), c.xy);
    vec2 high = max(max(a.xy, b.xy), c.xy);
    vec2 first = ceil(low - (0.5 + SNAP)) + 0.5;
    vec2 last = floor(high - (0.5 - SNAP)) + 0.5;
    bool between = first.x > last.x || first.y > last.y;
    /* Twice the area; which side is inside is not certain where it is as small as its own error. */
    float area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    float turn = area > 0.0 ? 1.0 : -1.0;
    bool beside = abs(area) > 1e-3 && (beyond(a.xy, b.xy, turn, first, last) ||
                  beyond(b.xy, c.xy, turn, first, last) || beyond(c.xy, a.xy, turn, first, last));
    return !behind && !(before && (between || beside));
}

/* From a bit for each map, of 32 triangles, to a bit for each triangle, of 32 maps. The masks are read
 * once, and few invocations are at it: what a read of shared memory costs on drivers that run on CPUs
 * goes by vectors of invocations. */
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
