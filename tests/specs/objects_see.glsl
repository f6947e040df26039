#ifdef VERTEX
layout(location = 0) out vec3 position;
layout(location = 1) flat out uint triangle;
void main()
{
    position = vertex_position;
    triangle = vertex_triangle;
    gl_Position = view.view_projection * vec4(vertex_position, 1.0);
}
#endif

#ifdef FRAGMENT
layout(location = 0) in vec3 position;
layout(location = 1) flat in uint triangle;
void main()
{
    uint object = scene_object(triangle);
    label = uvec4(object);
    local = vec4((scene_objects[object].inverse * vec4(position, 1.0)).xyz, 1.0);
}
#endif
