void main()
{
    of_r8ui = uvec4(200u, 1, 2, 3);
    of_rg8ui = uvec4(200u, 1, 2, 3);
    of_rgba8ui = uvec4(200u, 1, 2, 3);
    of_r16ui = uvec4(60000u, 1, 2, 3);
    of_rg16ui = uvec4(60000u, 1, 2, 3);
    of_rgba16ui = uvec4(60000u, 1, 2, 3);
}
