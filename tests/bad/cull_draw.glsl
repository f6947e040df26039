#ifdef VERTEX
void main()
{
    gl_Position = view.view_projection * vec4(vertex_position, 1.0);
}
#else
void main()
{
    color = vec4(1.0);
}
#endif
