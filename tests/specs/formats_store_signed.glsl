void main()
{
    ivec2 p = invocation().xy;
    if (p.x >= 20 || p.y >= 12)
        return;
    int n = p.x + 3 * p.y;
    of_r8i_store(p, ivec4(n, 1, 2, 3) - 50);
    of_rg8i_store(p, ivec4(n, 1, 2, 3) - 50);
    of_rgba8i_store(p, ivec4(n, 1, 2, 3) - 50);
    of_r16i_store(p, ivec4(n, 1, 2, 3) - 50);
    of_rg16i_store(p, ivec4(n, 1, 2, 3) - 50);
    of_rgba16i_store(p, ivec4(n, 1, 2, 3) - 50);
    of_rg32i_store(p, ivec4(n, 1, 2, 3) - 50);
    of_rgba32i_store(p, ivec4(n, 1, 2, 3) - 50);
}
