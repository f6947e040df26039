/* Height in the slab of each layer. Draws of lists have one part of the picture, those of the whole scene the rest. */
#ifdef VERTEX
layout(location = 0) out float height;

void main()
{
    Slab slab = slabs[gl_InstanceIndex];
    bool listed = slice_draws[gl_InstanceIndex].index_count > 0u;
    height = vertex_position.y - slab.low;
    gl_Position = view.view_projection * vec4(vertex_position, 1.0);
    gl_Position.x += listed == (whole == 1) ? 1e9 : 0.0; /* a layer is drawn once */
    gl_Layer = gl_InstanceIndex;
}
#else
layout(location = 0) in float height;

void main()
{
    if (height < 0.0 || height > 0.25 * frame.scene_radius)
        discard;
    slices = vec4(height);
}
#endif
