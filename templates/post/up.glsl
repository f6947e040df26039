/* The next coarser mip, filtered by a tent of 3x3 samples. */
void main()
{
    vec2 uv = gl_FragCoord.xy / vec2(ivec2(glow_x, glow_y) >> (levels - k));
    vec2 d = 1.0 / vec2(coarser_size());
    vec3 sum = vec3(0.0);
    for (int y = -1; y <= 1; y++)
        for (int x = -1; x <= 1; x++)
            sum += coarser_sample(uv + vec2(x, y) * d).rgb * float((2 - abs(x)) * (2 - abs(y)));
    glow = vec4(sum * (1.0 / 16.0), 0.0);
}
