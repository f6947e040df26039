void main()
{
    ivec2 p = invocation().xy;
    if (all(lessThan(p, marked_size())))
        marked_store(p, uvec4(floatBitsToUint(seen(p).x), textureQueryLevels(seen_texture), textureSize(seen_texture, 0)));
}
