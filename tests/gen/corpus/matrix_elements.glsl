// Elements by live indices, columns as l-values, swizzles of columns.
// expect: 5 9 4 1 8
void main()
{
    mat3 m = mat3(0.0);
    m[int(one)][int(two)] = 5.0 * one;
    result[0] = m[1].z;
    m[2].yx = vec2(9.0, 4.0) * one;
    result[1] = m[2][1];
    result[2] = m[2][0];
    int i = 0;
    m[i++] = vec3(one);
    result[3] = m[0].y * float(i);
    m[i][i] += 8.0;
    result[4] = m[1][1] * one;
}
