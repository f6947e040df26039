// Lists of declarations: arrays and values mixed, each made of those before.
// expect: 1 2 4 7 3
void main()
{
    float a = one, b = a + one, c[2] = float[2](b, b + b), d = c[1] + three;
    result[0] = a;
    result[1] = b;
    result[2] = c[1];
    result[3] = d;
    int i = 1, j = i++ + 1, k = j + i - int(one);
    result[4] = float(k) * one;
}
