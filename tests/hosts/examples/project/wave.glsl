void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, shown_size())))
        return;
    float x = float(p.x) / float(shown_size().x);
    shown_store(p, vec4(vec3(0.5 + 0.5 * sin(6.2831853 * stripes * x)), 1.0));
}
