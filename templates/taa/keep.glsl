void main()
{
    ivec2 p = invocation().xy;
    if (all(lessThan(p, resolved_size())))
        resolved_store(p, radiance(p));
}
