void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, irradiance_size())))
        return;
    settled_store(p, irradiance(p));
    settled_position_store(p, gbuffer_position(p));
}
