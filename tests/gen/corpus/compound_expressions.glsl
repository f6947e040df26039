// Long expressions of all operators.
// expect: 4.417922 1.3809524
void main()
{
    float a = 0.3 * one, b = 0.7 * one, c = 1.9 * one;
    result[0] = a * b + c / b - a * (b - c) / (a + c) + -b * -c;
    result[1] = (one + two) / (three + half_) * two - one / three;
}
