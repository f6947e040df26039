// A constant whose value is not known before the run.
// expect: 6 7 0.33333334
float twice(const float x)
{
    const float doubled = x * 2.0;
    return doubled;
}
void main()
{
    const float a = three;
    const float b = a + a;
    result[0] = b;
    const vec2 pair = vec2(twice(three), one);
    result[1] = pair.x + pair.y;
    const float third = one / three;
    result[2] = third;
}
