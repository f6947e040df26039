// step and smoothstep at their edges.
// expect: 0 1 1 0.5 0 1 0.25925928
void main()
{
    result[0] = step(two, one);
    result[1] = step(two, two);
    result[2] = step(vec2(one), vec2(three)).y;
    result[3] = smoothstep(0.0, two, one);
    result[4] = smoothstep(one, two, half_);
    result[5] = smoothstep(one, two, three);
    result[6] = smoothstep(0.0, three, one);
}
