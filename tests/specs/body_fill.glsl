void main()
{
    ivec2 p = invocation().xy;
    if (all(lessThan(p, pyramid_size())))
        pyramid_store(p, vec4(vec2(p), 0.0, 1.0));
}
