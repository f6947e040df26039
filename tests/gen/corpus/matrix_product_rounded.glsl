// Products of matrices round each product and each sum, from left to right.
// expect: 0.07 0.34 0.70000005
void main()
{
    mat2 a = mat2(0.1, 0.2, 0.3, 0.4) * one;
    mat2 b = mat2(0.1, 0.2, 0.7, 0.9) * one;
    mat2 c = a * b;
    result[0] = c[0][0];
    result[1] = c[1][0];
    result[2] = (a * vec2(one, two)).x;
}
