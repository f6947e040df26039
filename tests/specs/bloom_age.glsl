void main()
{
    ivec2 p = invocation().xy;
    if (all(lessThan(p, after_size())))
        after_store(p, (frame.first == 1u ? vec4(0.0) : before(p)) * 0.5 + glow(p));
}
