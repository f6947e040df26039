void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, shown_size())))
        return;
    vec4 c = over(p) + laced(p);
    imageStore(over_image, p, c);
    shown_store(p, clamp(c, 0.0, 1.0));
}
