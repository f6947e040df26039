void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, trail_size())))
        return;
    trail_store(p, mix(trail(p), laced(p), weight));
}
