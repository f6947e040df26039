void main()
{
    ivec2 p = invocation().xy;
    if (p.x >= 20 || p.y >= 12)
        return;
    vec2 uv = vec2(p) * 0.03125;
    vec4 total = of_r16_sample(uv) + of_rg16_sample(uv) + of_rgba16_sample(uv) + of_r16_snorm_sample(uv) + of_rg16_snorm_sample(uv) + of_rgba16_snorm_sample(uv);
    total += 0.0625 * of_r11g11b10f_sample(uv) + of_rgb10a2_sample(uv);
    sum_store(p, total);
}
