/* Lists of triangles: which lists have a triangle. A workgroup handles one chunk of consecutive
 * triangles, an invocation one triangle. Includers have main(). */

vec3 corner(uint k)
{
    SceneVertex v = scene_vertices[scene_indices[k]];
    return vec3(v.px, v.py, v.pz);
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

/* mask: a bit for each list that has the triangle. */
void store_lists(uvec4 mask)
{
    int chunk = int(gl_WorkGroupID.x);
    int lane = int(gl_LocalInvocationIndex);
    for (int word = 0; word < mask_words; word++)
        masks[(chunk * mask_words + word) * chunk_triangles + lane] = mask[word];
}
