// floor, ceil, trunc, roundEven and fract of both signs.
// expect: 1 2 -2 -1 -1 2 -2 0.5
void main()
{
    float x = one + half_;
    result[0] = floor(x);
    result[1] = ceil(x);
    result[2] = floor(-x);
    result[3] = ceil(-x);
    result[4] = trunc(-x);
    result[5] = roundEven(two + half_);
    result[6] = roundEven(-x);
    result[7] = fract(-x);
}
