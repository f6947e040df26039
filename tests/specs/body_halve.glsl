void main()
{
    ivec2 p = invocation().xy;
    if (all(lessThan(p, ivec2(8))))
        pyramid_store(p, pyramid(2 * p));
}
