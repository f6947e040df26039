#ifdef VERTEX
layout(location = 0) out vec3 world_normal;
void main()
{
    gl_Position = view.view_projection * vec4(vertex_position, 1.0);
    world_normal = vertex_normal * float(gl_InstanceIndex); /* the only instance's is 1 */
}
#endif
#ifdef FRAGMENT
layout(location = 0) in vec3 world_normal;
void main()
{
    half_color = vec4(0.5 + 0.5 * world_normal, gl_FrontFacing ? 1.0 : 0.5);
}
#endif
