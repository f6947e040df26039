// bitCount, findMSB and their family.
// expect: 3 5 31 -1 128 6 171 4
void main()
{
    result[0] = float(bitCount(int(three) + 16));
    result[1] = float(findMSB(32 + int(one)));
    result[2] = float(findMSB(uint(one) << 31));
    result[3] = float(findMSB(0 * int(one)));
    result[4] = float(bitfieldReverse(uint(one)) >> 24);
    result[5] = float(bitfieldExtract(uint(0x160 * int(one)), 4, 4));
    result[6] = float(bitfieldInsert(0xA0u, uint(three) + 8u, 0, 4));
    result[7] = float(findLSB(int(one) << 4));
}
