// Constants made of constants, as one expression; the same with a live factor, operation by operation.
// expect: 2 0.7 1.9999999
const float a = 0.7;
const float b = a * 3.0;
const float c = b - 0.1;
void main()
{
    result[0] = c * one;
    result[1] = a * one;
    result[2] = a * three - 0.1;
}
