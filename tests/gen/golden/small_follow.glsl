void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, trail_size())))
        return;
    vec4 now = lit(p) + halo(min(p / 2, halo_size() - 1));
    trail_store(p, mix(trail(p), now, gain));
}
