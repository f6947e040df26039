/* Keeps every other triangle for an indirect draw; what is left of the buffer is zero. One element per invocation: a loop
 * over all of them would end early on llvmpipe and lavapipe, which cut every loop off after 65,535 iterations. */
void main()
{
    int i = invocation().x;
    if (i >= kept_count)
        return;
    int triangles = min((int(frame.triangle_count) + keep_every - 1) / keep_every, kept_count / 3);
    int from = 3 * keep_every * (i / 3) + i % 3;
    kept[i] = i < 3 * triangles ? scene_indices[from] : 0u;
    if (i > 0)
        return;
    draw_arguments[0].index_count = uint(3 * triangles);
    draw_arguments[0].instance_count = 1u;
    draw_arguments[0].first_index = 0u;
    draw_arguments[0].vertex_offset = int(scene_objects[0].first_index); /* 0 */
    draw_arguments[0].first_instance = 1u;
}
