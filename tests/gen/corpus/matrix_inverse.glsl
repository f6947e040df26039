// Inverses of matrices of powers of two.
// expect: 0.5 0 0.25 -0.125 1
void main()
{
    mat2 m = mat2(two, one, 0.0, two + two);
    mat2 n = inverse(m);
    result[0] = n[0][0];
    result[1] = n[1][0] == 0.0 ? 0.0 : one; // of either sign
    result[2] = n[1][1];
    result[3] = n[0][1];
    result[4] = (n * m)[0][0];
}
