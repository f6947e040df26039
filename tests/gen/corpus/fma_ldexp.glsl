// fma, ldexp, frexp and modf.
// expect: 7 12 0.75 3 0.5 2
void main()
{
    result[0] = fma(two, three, one);
    result[1] = ldexp(three, int(two));
    int exponent;
    float mantissa = frexp(three, exponent);
    result[2] = mantissa;
    float whole;
    float part = modf(three + half_, whole);
    result[3] = whole;
    result[4] = part;
    result[5] = float(exponent) * one;
}
