/* Along rows, through centres of texels: the only lines that all devices draw alike. */
#ifdef VERTEX
void main()
{
    vec2 texel = vec2(1.5 + 10.0 * float(gl_VertexIndex), 0.5 + float(3 * gl_InstanceIndex));
    gl_Position = vec4(2.0 * texel / vec2(frame.width, frame.height) - 1.0, 0.0, 1.0);
}
#else
void main()
{
    marks = vec4(0.25);
}
#endif
