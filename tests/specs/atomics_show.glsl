void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, picture_size())))
        return;
    uint sum = tally(p).x + once(ivec2(p.x & 3, 0)).x + cells(ivec3(p & 1, p.x >> 1 & 1)).x;
    picture_store(p, vec4(float(sum & 255u) / 255.0, float(ends(ivec3(0, 0, p.y)).x & 255) / 255.0, 0.5, 1.0));
}
