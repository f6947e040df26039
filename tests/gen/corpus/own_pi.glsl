// The body's own PI, and constants made of it.
// expect: 3.1415927 6.2831855 0.034906585
const float PI = 3.14159265;
const float TWO_PI = 2.0 * PI;
const float DEGREE = PI / 180.0;
void main()
{
    result[0] = PI * one;
    result[1] = TWO_PI * one;
    result[2] = DEGREE * two;
}
