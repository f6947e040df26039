#ifdef VERTEX
void main()
{
    int k = gl_VertexIndex;
    vec2 corner = vec2(k == 1 || k == 4 || k == 5, k == 2 || k == 3 || k == 5);
    gl_Position = vec4(2.0 * corner - 1.0, 0.5, 1.0);
}
#else
void main()
{
    height = vec4(gl_FragCoord.x * 0.0625);
}
#endif
