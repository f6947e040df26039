// And, or, exclusive or, complement; and their assignments.
// expect: 6 7 1 -4 240 255
void main()
{
    int a = int(three) << 1, b = 7;
    result[0] = float(a & b);
    result[1] = float(a | b);
    result[2] = float(a ^ b);
    result[3] = float(~int(three));
    uint m = 0xffu * uint(one);
    m &= ~0xfu;
    result[4] = float(m);
    m |= 0xFu;
    m ^= 0u;
    result[5] = float(m);
}
