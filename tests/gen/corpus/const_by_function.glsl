// Calls of built-in functions with constants make constants: lengths of arrays and cases.
// expect: 8 1 5 3
const int N = int(sqrt(16.0)) + min(3, 4) + int(max(1.0, 1.5));
const int M = int(exp2(2.0)) + abs(-1);
void main()
{
    float a[N];
    float b[int(floor(2.5)) + 1];
    a[3] = one;
    result[0] = float(a.length()) * one;
    result[1] = a[3];
    switch (int(three) + 2) {
    case M: result[2] = float(M) * one; break;
    case N: result[2] = -1.0;
    }
    result[3] = float(b.length()) * one;
}
