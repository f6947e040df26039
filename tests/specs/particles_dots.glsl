#ifdef VERTEX
void main()
{
    vec2 texel = vec2(4.5 + 6.0 * float(gl_VertexIndex), 3.5 + 4.0 * float(gl_VertexIndex));
    gl_Position = vec4(2.0 * texel / vec2(frame.width, frame.height) - 1.0, 0.0, 1.0);
    gl_PointSize = float(2 * gl_VertexIndex + 1);
}
#else
void main()
{
    marks = vec4(gl_PointCoord, 1.0, 0.5);
}
#endif
