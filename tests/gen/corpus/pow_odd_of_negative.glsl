// Odd and negative whole powers of negative numbers.
// expect: -8 -1 0.25
// fast: skip
void main()
{
    result[0] = pow(-two, 3.0);
    result[1] = pow(-one, 5.0);
    result[2] = pow(-two, -2.0);
}
