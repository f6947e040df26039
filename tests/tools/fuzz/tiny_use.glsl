void main()
{
    ivec2 p = ivec2(invocation().xy);
    picture_store(p, vec4(old(p).x * gain, float(sums[1]), 0.0, 1.0));
}
