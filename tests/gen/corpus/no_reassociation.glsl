// Sums and products keep the order that the text gives them.
// expect: 16777216.0 16777218.0 0 0 1
// fast: skip
void main()
{
    float big = 16777216.0 * one;
    result[0] = big + one + one;
    result[1] = big + (one + one);
    float huge = 1e8 * one;
    result[2] = (huge + one) - huge;
    float p = 0.1 * three;
    result[3] = 0.1 * three - p;
    result[4] = three * (one / three);
}
