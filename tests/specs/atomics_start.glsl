void main()
{
    ivec3 p = invocation();
    if (p.y < 7 && p.z == 0)
        tally_store(p.xy, uvec4(p.y == 1 || p.y == 3 ? 0xffffffffu : 0u));
    if (p.x < 5 && p.y == 0 && p.z == 0)
        once_store(p.xy, uvec4(5u));
    if (all(lessThan(p, cells_size())))
        cells_store(p, uvec4(0u));
    if (p.x < 2 && p.y < 2)
        ends_store(p, ivec4(0));
}
