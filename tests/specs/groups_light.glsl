void main()
{
    ivec2 p = invocation().xy;
    if (all(lessThan(p, glow_size())))
        glow_store(p, first_canvas(p) + 2u * second_canvas(p));
}
