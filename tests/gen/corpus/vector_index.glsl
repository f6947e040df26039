// Components by live indices, on both sides.
// expect: 3 7 2 3
void main()
{
    vec3 v = vec3(one, two, three);
    result[0] = v[int(two)];
    v[int(one)] = 7.0 * one;
    result[1] = v.y;
    ivec4 order = ivec4(3, 2, 1, 0);
    result[2] = float(order[order[int(two)]]) * one;
    result[3] = float(v.length()) * one;
}
