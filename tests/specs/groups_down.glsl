void main()
{
    ivec2 p = invocation().xy;
    if (all(lessThan(p, coarser_size())))
        coarser_store(p, finer(2 * p) + uint(LEVEL + k));
}
