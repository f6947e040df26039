void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, picture_size())))
        return;
    uint sums = first_light_sum[0] + part_2_sum[0];
    picture_store(p, vec4(second_canvas(p).x % 256u, keys_0[p.x * 2] % 256u, (glow(p).x + sums) % 256u, 255u) / 255.0);
}
