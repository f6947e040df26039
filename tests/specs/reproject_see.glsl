#ifdef VERTEX
layout(location = 0) out vec3 position;
void main()
{
    position = vertex_position;
    gl_Position = view.view_projection * vec4(vertex_position, 1.0);
}
#endif

#ifdef FRAGMENT
layout(location = 0) in vec3 position;
void main()
{
    seen = vec4(position, 1.0);
}
#endif
