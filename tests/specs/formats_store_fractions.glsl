void main()
{
    ivec2 p = invocation().xy;
    if (p.x >= 20 || p.y >= 12)
        return;
    int n = p.x + 3 * p.y;
    of_r16_store(p, vec4(1000 * n, n, n + 1, 7) / 65535.0);
    of_rg16_store(p, vec4(1000 * n, n, n + 1, 7) / 65535.0);
    of_rgba16_store(p, vec4(1000 * n, n, n + 1, 7) / 65535.0);
    of_r16_snorm_store(p, vec4(250 * n - 10000, n, -n, 7) / 32767.0);
    of_rg16_snorm_store(p, vec4(250 * n - 10000, n, -n, 7) / 32767.0);
    of_rgba16_snorm_store(p, vec4(250 * n - 10000, n, -n, 7) / 32767.0);
    of_r11g11b10f_store(p, vec4(n, 0.5 * float(n), n % 32, 1.0));
    of_rgb10a2_store(p, vec4(10 * n, n, 1023 - n, 341 * (n % 4)) / 1023.0);
}
