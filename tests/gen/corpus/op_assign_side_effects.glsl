// All op-assignments with side effects on the left.
// expect: 5 3 12 1 2 4
void main()
{
    float a[4] = float[4](2.0, 4.0, 6.0, 8.0);
    int i = 0;
    a[i++] += three;
    a[i++] -= one;
    a[i++] *= two;
    result[0] = a[0] * one;
    result[1] = a[1];
    result[2] = a[2];
    int n[2] = int[2](7, 9);
    int k = 0;
    n[k++] %= 2 * int(one);
    n[k--] >>= 2;
    result[3] = float(n[0]);
    result[4] = float(n[1]);
    result[5] = float(k) + float(i) + one;
}
