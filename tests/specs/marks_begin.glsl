void main()
{
    ivec2 p = invocation().xy;
    tint_store(p, vec4(0.25));
    if (all(lessThan(p, marks_size())))
        marks_store(p, uvec4(5u));
}
