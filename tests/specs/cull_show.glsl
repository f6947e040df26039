void main()
{
    ivec2 p = invocation().xy;
    if (p.x >= picture_size().x || p.y >= picture_size().y)
        return;
    bool same = all(equal(full(p), seen(p)));
    float slice = slices(ivec3(p % slices_size().xy, (p.x / 8) % 3)).x;
    picture_store(p, vec4(same ? 0.0 : 1.0, fract(slice), fract(seen(p).x), 1.0));
}
