// Conversions out of range give the nearest number.
// expect: 2147483600.0 -2147483600.0 4294967300.0 0
// fast: skip
void main()
{
    result[0] = float(int(3e9 * one));
    result[1] = float(int(-3e9 * one));
    result[2] = float(uint(5e9 * one));
    result[3] = float(uint(-one));
}
