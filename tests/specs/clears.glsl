#ifdef VERTEX
void main()
{
    gl_Position = vec4(0.0, 0.0, 0.0, 1.0);
}
#else
void main()
{
    halves = small = bytes = wide = negative = tens = eleven = coded = vec4(0.0);
}
#endif
