// PI as a local variable and as a parameter.
// expect: 4 7
float with(float PI) { return PI + three; }
void main()
{
    float PI = 4.0 * one;
    result[0] = PI;
    result[1] = with(PI);
}
