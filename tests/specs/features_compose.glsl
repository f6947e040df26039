void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, hdr_size())))
        return;
    ivec3 q = ivec3(p % slices_size(), (p.x + p.y) % 3);
    float flat_depth = depth(p) + slice_depth(q);
    float remembered = float(memory[p.x % 4] + marks[p.y % bins]);
    hdr_store(p, vec4(blurred(p).rgb + slices(q).rgb + color(p).rgb * flat_depth, remembered) + trail(p));
}
