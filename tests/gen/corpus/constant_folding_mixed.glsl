// Which operands are constants decides what is computed ahead.
// expect: 0.33333334 0.33333334 0.20000002 0.2
void main()
{
    result[0] = 1.0 / 3.0 * one;
    result[1] = one * 1.0 / 3.0;
    result[2] = 2.0 / 3.0 * 0.1 * three;
    result[3] = three * 2.0 / 3.0 * 0.1;
}
