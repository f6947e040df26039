#ifdef VERTEX
void main()
{
    vec2 corner = vec2(gl_VertexIndex << 1 & 2, gl_VertexIndex & 2);
    gl_Position = vec4(2.0 * corner - 1.0, 0.25, 1.0);
    gl_PointSize = 2.0;
#ifdef CUTS
    gl_ClipDistance[0] = 1.0 - corner.x;
#endif
}
#else
void main()
{
    marks = uvec4(1u);
}
#endif
