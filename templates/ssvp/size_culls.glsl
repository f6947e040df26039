/* Number of workgroups that cull the scene's triangles; 0 if there are more than cull_chunks. */
void main()
{
    uint chunks = (frame.triangle_count + uint(chunk_triangles) - 1u) / uint(chunk_triangles);
    cull_groups[0] = chunks <= uint(cull_chunks) ? chunks : 0u;
    cull_groups[1] = 1u;
    cull_groups[2] = 1u;
}
