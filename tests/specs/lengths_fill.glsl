void main()
{
    int i = invocation().x;
    if (i < one.length())
        one[i] = 1u;
    if (i < three.length())
        three[i] = 2;
    if (i < wide.length())
        wide[i] = vec3(3.0);
    if (i < lamps.length())
        lamps[i] = Lamp(vec3(4.0), 5.0, vec2(6.0));
    if (i < pairs.length())
        pairs[i] = vec2(7.0);
    if (i < counted.length())
        counted[i] = vec4(8.0);
}
