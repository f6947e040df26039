// Random bits as the mantissa of a number from 1 to 2.
// expect: 0.5 0.40834904 0.8166981
uint mix_bits(uint x)
{
    x ^= x >> 16u;
    x *= 0x7feb352du;
    x ^= x >> 15u;
    x *= 0x846ca68bu;
    x ^= x >> 16u;
    return x;
}
float random(uint seed)
{
    return uintBitsToFloat(0x3f800000u | (mix_bits(seed) >> 9)) - 1.0;
}
void main()
{
    result[0] = uintBitsToFloat(0x3f800000u | (0x80000000u * uint(one) >> 9)) - 1.0;
    result[1] = random(uint(one));
    result[2] = random(uint(two));
}
