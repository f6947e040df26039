void main()
{
    ivec2 p = invocation().xy;
    pyramid_store(p, vec4(vec2(p) / 64.0, 0.5, 1.0));
    if (p.x < 4 && p.y == 0)
        program_fill[p.x] = uint(p.x);
}
