// A matrix and a number, each operator on each side.
// expect: 0.33333334 0.6666667 5 4 0 0
void main()
{
    mat3x2 m = mat3x2(one, two, three, one, 0.0, 0.0);
    m /= three;
    result[0] = m[0][0];
    result[1] = m[0][1];
    mat2x3 n = mat2x3(one, two, three, one, two, three) + two;
    result[2] = n[0][2];
    result[3] = (n - one + n - n)[1].y + one;
    result[4] = (0.0 * n)[1][1];
    result[5] = m[2][1];
}
