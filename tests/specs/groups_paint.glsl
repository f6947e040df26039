void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, canvas_size())))
        return;
    uint value = light_sum[0];
    for (int i = 0; i < count; i++)
        value += (uint(i) + items[i].weight) * uint((p.x + 3 * p.y) % 7);
    canvas_store(p, uvec4(uint(float(value) * float(scale) * weights.y), 0u, 0u, 0u));
}
