void main()
{
    int at = invocation().x;
    mediump float half_precision = seen(ivec2(at & 7, at >> 3)).x;
    values[at] = half_precision + 1.0;
    rest[at] = atomicExchange(rest[0], uint(at)); /* first come, first served */
    if (seen_sample(vec2(0.5)).x > 0.0)
        values[at] = textureLod(seen_texture, vec2(values[at]), 0.0).y;
}
