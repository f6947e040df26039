/* Sums in a fixed order. */
vec4 mean(ivec2 p)
{
    return (finer(p) + finer(p + ivec2(1, 0)) + finer(p + ivec2(0, 1)) + finer(p + ivec2(1, 1))) * 0.25;
}

void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, half_size_size())))
        return;
    half_size_store(p, mean(p * 2));
    if (all(lessThan(p, quarter_size_size())))
        quarter_size_store(p, (mean(p * 4) + mean(p * 4 + ivec2(2, 0)) + mean(p * 4 + ivec2(0, 2)) + mean(p * 4 + 2)) * 0.25);
}
