// Integers wrap around.
// expect: -2147483600.0 4294967300.0 0 1
void main()
{
    int big = 2147483647 + 0 * int(one);
    big += int(one);
    result[0] = float(big);
    uint low = uint(one) - 2u;
    result[1] = float(low);
    result[2] = float(low + uint(one));
    result[3] = float(low * low);
}
