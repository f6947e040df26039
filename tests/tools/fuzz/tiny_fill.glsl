void main()
{
    ivec2 p = ivec2(invocation().xy);
    old_store(p, vec4(float(p.x)));
    if (p.y == 0 && p.x < 4)
        sums[p.x] = uint(p.x);
}
