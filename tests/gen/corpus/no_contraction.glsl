// A product and a sum are two roundings.
// expect: 0 0 0
// fast: skip
void main()
{
    float a = 0.1 * one;
    float p = a * a;
    result[0] = a * a - p;
    float x = 1.0 + one / 4096.0, y = 1.0 + one / 2048.0;
    result[1] = x * x - y;
    float b = 1.1 * one;
    result[2] = b * b + -1.21;
}
