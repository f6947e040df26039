void main()
{
    ivec2 p = invocation().xy;
    if (p.x >= 20 || p.y >= 12)
        return;
    int n = p.x + 3 * p.y;
    of_r8ui_store(p, uvec4(n, n + 1, n + 2, n + 3));
    of_rg8ui_store(p, uvec4(n, n + 1, n + 2, n + 3));
    of_rgba8ui_store(p, uvec4(n, n + 1, n + 2, n + 3));
    of_r16ui_store(p, uvec4(n, n + 1, n + 2, n + 3));
    of_rg16ui_store(p, uvec4(n, n + 1, n + 2, n + 3));
    of_rgba16ui_store(p, uvec4(n, n + 1, n + 2, n + 3));
}
