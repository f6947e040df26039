/* Adds the next coarser mip, filtered by a tent of 3x3 samples. */
void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, glow_size())))
        return;
    vec2 uv = (vec2(p) + 0.5) / vec2(glow_size());
    vec2 d = 1.0 / vec2(coarser_size());
    vec3 sum = vec3(0.0);
    for (int y = -1; y <= 1; y++)
        for (int x = -1; x <= 1; x++)
            sum += coarser_sample(uv + vec2(x, y) * d).rgb * float((2 - abs(x)) * (2 - abs(y)));
    glow_store(p, vec4(glow(p).rgb + sum * (1.0 / 16.0), 1.0));
}
