void main()
{
    ivec2 p = invocation().xy;
    if (p.x >= 20 || p.y >= 12)
        return;
    uvec4 u = of_r8ui(p) + of_rg8ui(p) + of_rgba8ui(p) + of_r16ui(p) + of_rg16ui(p) + of_rgba16ui(p);
    ivec4 i = of_r8i(p) + of_rg8i(p) + of_rgba8i(p) + of_r16i(p) + of_rg16i(p) + of_rgba16i(p) + of_rg32i(p) + of_rgba32i(p);
    picture_store(p, (sum(p) + vec4(u & 255u) / 255.0 + vec4(i & 255) / 255.0) / 3.0);
}
