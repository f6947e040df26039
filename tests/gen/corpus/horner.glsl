// A polynomial by a loop over constant coefficients.
// expect: 0.056250002 5.7
const float coefficients[5] = float[](0.1, -0.2, 0.3, -0.4, 0.5);
float polynomial(float x)
{
    float y = coefficients[4];
    for (int i = 3; i >= 0; --i)
        y = y * x + coefficients[i];
    return y;
}
void main()
{
    result[0] = polynomial(half_);
    result[1] = polynomial(two);
}
