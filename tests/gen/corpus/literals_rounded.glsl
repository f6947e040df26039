// Decimal literals become the nearest float.
// expect: 0.1 3.1415927 16777216.0 2.3509887e-38 1
void main()
{
    result[0] = 0.1 * one;
    result[1] = 3.14159265358979323846 * one;
    result[2] = 16777217.0 * one;
    result[3] = 1.17549435e-38 * two;
    result[4] = 0.333333343 * three;
}
