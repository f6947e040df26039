#ifdef VERTEX
void main()
{
    gl_Position = vec4(vec2(gl_VertexIndex << 2 & 4, gl_VertexIndex << 1 & 4) - 1.0, 0.25, 1.0);
}
#else
void main()
{
    marks = uvec4(2u);
    gl_FragDepth = gl_FragCoord.x / 8.0;
}
#endif
