// Bounds that are known at run time only; a float counter.
// expect: 6 12 1
void main()
{
    float s = 0.0;
    for (int i = int(one); i <= int(three); i++)
        s += float(i);
    result[0] = s;
    s = 0.0;
    for (float x = 0.0; x < three; x += half_)
        s += two;
    result[1] = s;
    s = one;
    for (int i = int(three); i < int(two); i++)
        s = 100.0;
    result[2] = s;
}
