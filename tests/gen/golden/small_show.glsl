void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, shown_size())))
        return;
    shown_store(p, vec4(clamp(trail(p).rgb, 0.0, 1.0), 1.0));
}
