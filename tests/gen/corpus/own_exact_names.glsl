// Names that a generator could use inside.
// expect: 4 3 2 12
float exact_divide(float a, float b) { return a + b; }
float exact_sqrt(float x) { return x; }
float mul(float a, float b) { return a * b; }
const float exact = 2.0;
float fast(float x) { return x * exact; }
void main()
{
    result[0] = exact_divide(one, three);
    result[1] = exact_sqrt(three);
    result[2] = exact * one;
    result[3] = fast(mul(two, three));
}
