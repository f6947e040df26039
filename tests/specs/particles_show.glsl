void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, picture_size())))
        return;
    vec4 sum = over(p) + premultiplied(p) + added(p) + least(p) + largest(p) + multiplied(p) + mixed(p) + vec4(tally(p)) / 256.0;
    sum.rg += vec2(counted(p).r, height(p).r) * 0.25;
    picture_store(p, vec4(mix(sum.rgb / 8.0, marks(p).rgb, 0.25), 1.0));
}
