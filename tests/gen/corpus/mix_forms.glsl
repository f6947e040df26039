// mix is x * (1 - a) + y * a, by component and by one factor.
// expect: 1.3 2.3999999 2 1 2.1
void main()
{
    result[0] = mix(one, two, 0.3);
    vec2 m = mix(vec2(one), vec2(two, three), 0.7 * one);
    result[1] = m.y;
    result[2] = mix(one, two, one < two);
    result[3] = mix(one, two, 0.0 * two);
    result[4] = mix(vec2(two), vec2(three), vec2(0.5, 0.1) * one).y;
}
