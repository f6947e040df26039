void main()
{
    ivec3 p = invocation();
    if (any(greaterThanEqual(p, coarser_size())))
        return;
    vec4 sum = vec4(0.0);
    for (int i = 0; i < 8; i++)
        sum += finer(min(2 * p + ivec3(i & 1, i >> 1 & 1, i >> 2), finer_size() - 1));
    coarser_store(p, 0.125 * sum);
}
