void main()
{
    of_r8i = ivec4(-100, -1, -2, 3);
    of_rg8i = ivec4(-100, -1, -2, 3);
    of_rgba8i = ivec4(-100, -1, -2, 3);
    of_r16i = ivec4(-30000, -1, -2, 3);
    of_rg16i = ivec4(-30000, -1, -2, 3);
    of_rgba16i = ivec4(-30000, -1, -2, 3);
    of_rg32i = ivec4(-2000000000, -1, -2, 3);
    of_rgba32i = ivec4(-2000000000, -1, -2, 3);
}
