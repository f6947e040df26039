// Shifts of signed and unsigned numbers, by vectors, by mixed types.
// expect: 12 -2 1073741800.0 1 5
void main()
{
    result[0] = float(int(three) << 2);
    result[1] = float(-8 >> int(two));
    result[2] = float(uint(0xffffffffu * uint(one)) >> 2u) + 1.0;
    ivec2 v = ivec2(4, 16) >> ivec2(int(two), 3);
    result[3] = float(v.x);
    uint u = 0x50u;
    u >>= int(three) + 1;
    result[4] = float(u);
}
