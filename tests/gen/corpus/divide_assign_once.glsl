// The left side of an assignment is evaluated once.
// expect: 2.6666667 16 32 1 8 2
int calls = 0;
int place() { return calls++; }
void main()
{
    float a[3] = float[3](8.0, 16.0, 32.0);
    int i = 0;
    a[i++] /= two + one;
    result[0] = a[0];
    result[1] = a[1];
    result[2] = a[2];
    result[3] = float(i);
    a[place() + 1] /= two;
    result[4] = a[1];
    a[place()] *= one;
    result[5] = float(calls) * one;
}
