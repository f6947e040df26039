// Conversions between signed and unsigned keep the bits.
// expect: 4294967300.0 -1 3 1 0 4294967300.0
void main()
{
    int minus = -int(one);
    result[0] = float(uint(minus));
    result[1] = float(int(uint(minus)));
    result[2] = float(uint(three + half_));
    result[3] = float(bool(minus));
    result[4] = float(int(bool(0 * minus)));
    uint implied = 4294967295u;
    result[5] = float(implied) * one;
}
