void main()
{
    ivec2 p = invocation().xy;
    if (all(lessThan(p, picture_size())))
        picture_store(p, vec4(float(sums[p.x + 16 * p.y]) / 16384.0));
}
