// Quotients are rounded to nearest.
// expect: 0.33333334 0.6666667 1.4285715 0.020408163 3.3333333e-21 1.4285715e+19 -1.6666666
void main()
{
    result[0] = one / three;
    result[1] = two / three;
    result[2] = 10.0 * one / 7.0;
    result[3] = one / (7.0 * 7.0);
    result[4] = 1e-20 * one / three;
    result[5] = 1e20 / (7.0 * one);
    result[6] = 5.0 * one / -three;
}
