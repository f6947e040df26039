// Constants by macros: in an array's size, a case and a product.
// expect: 0.33333334 3 3.14159 6
#define TAU 2.0 * 3.14159
#define THIRD (1.0 / 3.0)
#define N 1 + 2
void main()
{
    float list[N];
    list[N - 1] = THIRD * one;
    result[0] = list[2];
    result[1] = float(list.length()) * one;
    result[2] = half_ * (TAU);
    switch (int(three)) {
    case N: result[3] = two * three; break;
    default: result[3] = 0.0;
    }
}
