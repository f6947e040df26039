#ifdef VERTEX
void main()
{
    gl_Position = vec4(vec2(gl_VertexIndex - 1) * 0.5, 0.0, 1.0);
    gl_PointSize = 5.0;
}
#else
void main()
{
    over = vec4(gl_PointCoord, 0.0, 0.5);
}
#endif
