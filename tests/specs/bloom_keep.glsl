void main()
{
    ivec2 p = invocation().xy;
    if (all(lessThan(p, before_size())))
        before_store(p, after(p));
}
