// isnan and isinf of numbers made by bits.
// expect: 1 0 1 0
// fast: skip
void main()
{
    float infinity = uintBitsToFloat(0x7f800000u * uint(one));
    float not_a_number = uintBitsToFloat(0x7fc00000u * uint(one));
    result[0] = float(isinf(infinity));
    result[1] = float(isnan(infinity));
    result[2] = float(isnan(not_a_number));
    result[3] = float(isinf(one) || isnan(one));
}
