#ifdef VERTEX
layout(location = 0) out vec3 place;

void main()
{
    place = vertex_position;
    gl_Position = view.view_projection * vec4(vertex_position, 1.0);
}
#else
layout(location = 0) in vec3 place;

void main()
{
    color = vec4(place, 1.0);
}
#endif
