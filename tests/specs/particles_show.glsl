void main()
{
    ivec2 p = invocation().xy;
    vec4 sum = over(p) + premultiplied(p) + added(p) + least(p) + most(p) + multiplied(p) + mixed(p) + vec4(tally(p)) / 256.0;
    picture_store(p, vec4(sum.rgb / 8.0, 1.0));
}
