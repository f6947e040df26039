/* First triangle and number of triangles of a block of the scene; none, in blocks that a small scene
 * leaves over. Included by what bounds the blocks and by what culls them. */
ivec2 block_triangles(int block)
{
    int total = int(frame.triangle_count);
    int each = (total + cull_blocks - 1) / cull_blocks;
    int first = min(block * each, total);
    return ivec2(first, min(each, total - first));
}
