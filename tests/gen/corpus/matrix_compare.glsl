// Matrices and vectors as wholes in comparisons.
// expect: 1 0 1
void main()
{
    mat2 a = mat2(one), b = mat2(one, 0.0, 0.0, one);
    result[0] = float(a == b);
    b[1][0] += one;
    result[1] = float(a == b);
    result[2] = float(a != b && vec2(one, two) == vec2(one, three - one));
}
