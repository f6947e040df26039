// Conditions that assign.
// expect: 3 1 2
void main()
{
    int n = 0;
    bool flag;
    if (flag = one < two)
        n = 3;
    result[0] = float(n) * one;
    result[1] = float(flag) * one;
    int k = 5;
    while ((k -= 1) > 2)
        ;
    result[2] = float(k) * one;
}
