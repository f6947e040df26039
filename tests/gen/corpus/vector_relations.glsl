// Comparisons of vectors, any, all, not, and mix by bools.
// expect: 1 0 1 2 5
void main()
{
    vec3 a = vec3(one, two, three), b = vec3(three, two, one);
    result[0] = float(any(lessThan(a, b)));
    result[1] = float(all(lessThanEqual(a, b)));
    result[2] = float(all(not(notEqual(a, vec3(one, two, three)))));
    vec3 m = mix(a, b, greaterThan(b, a));
    result[3] = m.y;
    result[4] = dot(vec3(equal(a, b)), b) + m.x;
}
