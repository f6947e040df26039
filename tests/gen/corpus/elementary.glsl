// Functions that the standards leave open, near their true values.
// expect: 2.7182817 1.0986123 0.84147096 -0.41614684 15.588457 1.4142135 1.5849625 0.4636476 0.5235988 1.5574077
// tolerance: ulp 4
void main()
{
    result[0] = exp(one);
    result[1] = log(three);
    result[2] = sin(one);
    result[3] = cos(two);
    result[4] = pow(three, two + half_);
    result[5] = exp2(half_);
    result[6] = log2(three);
    result[7] = atan(one, two);
    result[8] = asin(half_);
    result[9] = tan(one);
}
