// Square roots are rounded to nearest.
// expect: 1.4142135 1.7320508 3 0.70710677 0.0000000001 10000000000.0 0
void main()
{
    result[0] = sqrt(two);
    result[1] = sqrt(three);
    result[2] = sqrt(three * three);
    result[3] = sqrt(half_);
    result[4] = sqrt(1e-20 * one);
    result[5] = sqrt(1e20 * one);
    result[6] = sqrt(0.0 * one);
}
