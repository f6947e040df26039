// The sign of zero.
// expect: -0.0 1 0 -0.0
// fast: skip
void main()
{
    float zero = one - one;
    result[0] = -zero;
    result[1] = float(floatBitsToUint(-zero) >> 31);
    result[2] = zero + -zero;
    result[3] = zero * -three;
}
