/* Number of workgroups that cull the scene's triangles; 0 in larger scenes than cull_most. */
void main()
{
    uint needed = (frame.triangle_count + uint(chunk_triangles) - 1u) / uint(chunk_triangles);
    groups[0] = needed <= uint(chunks) ? needed : 0u;
    groups[1] = 1u;
    groups[2] = 1u;
}
