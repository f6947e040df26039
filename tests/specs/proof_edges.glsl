#ifdef VERTEX
layout(location = 0) out float away;
layout(location = 1) flat out uint triangle;

void main()
{
    gl_Position = view.view_projection * vec4(vertex_position, 1.0);
    away = gl_Position.w;
    triangle = vertex_triangle;
}
#endif

#ifdef FRAGMENT
layout(location = 0) in float away;
layout(location = 1) flat in uint triangle;

void main()
{
    if (dFdx(away) > 0.125)
        discard;
    number = uvec4(triangle + 1u, 0u, 0u, 1u);
}
#endif
