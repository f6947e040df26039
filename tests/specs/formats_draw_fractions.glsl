void main()
{
    of_r16 = vec4(0.2, 0.4, 2.0, 1.0);
    of_rg16 = vec4(0.2, 0.4, 2.0, 1.0);
    of_rgba16 = vec4(0.2, 0.4, 2.0, 1.0);
    of_r16_snorm = vec4(-0.2, 0.4, 2.0, 1.0);
    of_rg16_snorm = vec4(-0.2, 0.4, 2.0, 1.0);
    of_rgba16_snorm = vec4(-0.2, 0.4, 2.0, 1.0);
}
