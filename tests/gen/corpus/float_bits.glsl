// Bits of floats as numbers.
// expect: 1.5 1065353200.0 -1 2 127
void main()
{
    result[0] = uintBitsToFloat(0x3fc00000u * uint(one));
    result[1] = float(floatBitsToInt(one));
    result[2] = intBitsToFloat(floatBitsToInt(one) | int(0x80000000u));
    result[3] = uintBitsToFloat(floatBitsToUint(one) + (1u << 23));
    result[4] = float(floatBitsToUint(one) >> 23);
}
