// Extracted signed fields carry their sign.
// expect: -2 6 -1 0
void main()
{
    result[0] = float(bitfieldExtract(0x60 * int(one), 4, 4) - 8);
    result[1] = float(bitfieldExtract(0x60u * uint(one), 4, 4));
    result[2] = float(bitfieldExtract(0xF0 * int(one), 4, 4));
    result[3] = float(bitfieldExtract(-1 * int(one), 3, 0));
}
