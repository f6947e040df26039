// A quotient by a constant is no product with its reciprocal.
// expect: 0.6666667 20 0.011764706 0.003921569 0.6666667
void main()
{
    const float k = 3.0;
    result[0] = two / k;
    result[1] = two / 0.1;
    result[2] = three / 255.0;
    result[3] = one * (1.0 / 255.0);
    result[4] = two / float(int(k));
}
