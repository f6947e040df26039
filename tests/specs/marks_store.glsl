#ifdef VERTEX
void main() { int v = gl_VertexIndex % 3; gl_Position = vec4(4.0 * vec2(v & 1, v >> 1) - 1.0, 0.5, 1.0); }
#else
void main()
{
    ivec2 p = ivec2(gl_FragCoord.xy);
    if (p.x % 3 == 1)
        discard;
    marks_atomicAdd(p / 2, uint(p.x));
    tint_store(p, vec4(p, tint(ivec2(1, p.y)).r, 1.0));
    shown = vec4(0.0);
}
#endif
