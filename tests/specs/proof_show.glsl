void main()
{
    ivec2 p = invocation().xy;
    if (all(lessThan(p, shown_size())))
        shown_store(p, vec4(marked(p) & 255u) * 0.00390625);
}
