#ifdef VERTEX
void main()
{
    gl_Position = vec4(gl_VertexIndex == 1 ? 3.0 : -1.0, gl_VertexIndex == 2 ? 3.0 : -1.0, 0.0, 1.0);
    gl_Position.z = float(gl_InstanceIndex) / 16.0;
    gl_Layer = gl_InstanceIndex;
}
#endif
#ifdef FRAGMENT
void main()
{
}
#endif
