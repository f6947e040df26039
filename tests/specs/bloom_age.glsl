void main()
{
    ivec2 p = invocation().xy;
    if (all(lessThan(p, after_size())))
        after_store(p, before(p) * 0.5 + glow(p));
}
