// Quotients of integers are cut towards zero.
// expect: 3 -3 2 1 2147483600.0
void main()
{
    result[0] = float(7 / int(two));
    result[1] = float(-7 / int(two));
    result[2] = float(17 % int(three));
    result[3] = float(uint(three) / 2u);
    result[4] = float(4294967295u / uint(two) + 1u);
}
