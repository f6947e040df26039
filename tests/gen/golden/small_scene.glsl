#ifdef VERTEX
layout(location = 0) out vec3 world_normal;
void main()
{
    gl_Position = view.view_projection * vec4(vertex_position, 1.0);
    world_normal = vertex_normal;
}
#endif
#ifdef FRAGMENT
layout(location = 0) in vec3 world_normal;
void main()
{
    normal = vec4(world_normal, 1.0);
}
#endif
