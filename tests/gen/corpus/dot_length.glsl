// dot, length and distance.
// expect: 14 5 3.7416575 11 1.4142135 3
void main()
{
    vec3 v = vec3(one, two, three);
    result[0] = dot(v, v);
    result[1] = length(vec2(three, two + two));
    result[2] = length(v);
    result[3] = dot(vec2(three, one), vec2(three, two));
    result[4] = distance(vec2(one), vec2(two));
    result[5] = length(-three);
}
