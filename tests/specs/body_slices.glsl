#ifdef VERTEX
layout(location = 0) out vec3 eye;
void main()
{
    eye = (view.view * vec4(vertex_position, 1.0)).xyz;
    gl_Layer = gl_InstanceIndex;
    gl_Position = view.projection * vec4(eye, 1.0);
    gl_ClipDistance[0] = dot(vertex_position - view.position, view.direction) - float(gl_InstanceIndex);
}
#endif
#ifdef FRAGMENT
layout(location = 0) in vec3 eye;
void main()
{
    vec4 world = view.inverse_view_projection * vec4(eye, 1.0);
    layers = vec4(world.xyz, (view.far_plane - view.near_plane) * PI);
}
#endif
