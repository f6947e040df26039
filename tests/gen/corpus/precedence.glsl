// Precedence and associativity of operators.
// expect: 7 1 0 0.75 3 1 11
void main()
{
    result[0] = one + two * three;
    result[1] = float(1 + 2 << 1 == 6);
    result[2] = three - one - two;
    result[3] = three / two / two;
    result[4] = float(int(one) | int(two) ^ int(three) & 6 ^ 4) - float(int(two));
    result[5] = float(one < two == true && !(two < one) || false);
    result[6] = float(int(three) << 2 | 3 & ~4) - 4.0;
}
