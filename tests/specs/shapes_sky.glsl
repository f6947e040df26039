#ifdef VERTEX
layout(location = 0) flat out int face;
void main()
{
    gl_Position = vec4(gl_VertexIndex == 1 ? 3.0 : -1.0, gl_VertexIndex == 2 ? 3.0 : -1.0, 0.0, 1.0);
    gl_Position.z = 0.125 * float(gl_InstanceIndex + 1);
    gl_Layer = face = gl_InstanceIndex;
}
#endif
#ifdef FRAGMENT
layout(location = 0) flat in int face;
void main()
{
    ivec2 p = ivec2(gl_FragCoord.xy);
    sky = vec4(float(face) / 8.0, float(p.x) / 8.0, float(p.y) / 8.0, 1.0);
}
#endif
