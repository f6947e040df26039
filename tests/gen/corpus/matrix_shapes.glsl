// Matrices of unlike columns and rows.
// expect: 22 28 3 2 14 6 21
void main()
{
    mat2x3 a = mat2x3(1.0, 2.0, 3.0, 4.0, 5.0, 6.0) * one;
    mat3x2 b = mat3x2(one, two, three, 4.0, 5.0, 6.0);
    mat3x3 ab = a * b;
    mat2 ba = b * a;
    result[0] = ba[0][0];
    result[1] = ba[0][1];
    result[2] = float(a[0].length()) * one;
    result[3] = float(a.length()) * one;
    vec2 t = vec3(one, two, three) * a;
    result[4] = t.x;
    mat4x2 wide = mat4x2(one);
    result[5] = wide[0][0] + wide[1][1] + wide[2][0] + wide[3][1] + 4.0;
    result[6] = ab[0][1] + ab[2][0] - ab[1][2] + 13.0;
}
