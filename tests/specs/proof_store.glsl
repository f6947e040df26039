void main()
{
    ivec2 p = invocation().xy;
    if (all(lessThan(p, seen_size())))
        seen_store(p, vec4(floats[p.y * 32 + p.x].of[0], floats[p.y * 32 + p.x].of[3], 0.5, float(floats.length())));
}
