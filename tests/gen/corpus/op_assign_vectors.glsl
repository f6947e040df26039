// Op-assignments on vectors, swizzles and columns.
// expect: 2 6 0.5 0.33333334 4
void main()
{
    vec3 v = vec3(one, two, three);
    v *= two;
    result[0] = v.x;
    v.yz /= vec2(one, one);
    result[1] = v.z;
    vec2 w = vec2(one);
    w /= vec2(two, three);
    result[2] = w.x;
    result[3] = w.y;
    mat2 m = mat2(one);
    m[1] += vec2(three);
    result[4] = m[1][1];
}
