// Names of a condition and of a loop.
// expect: 3 0 11
void main()
{
    int i = 11;
    float r = 0.0;
    for (int i = 0; i < 3; i++)
        r += one;
    result[0] = r;
    int k = 3;
    while (k > 0)
        k -= 1;
    result[1] = float(k);
    result[2] = float(i) * one;
}
