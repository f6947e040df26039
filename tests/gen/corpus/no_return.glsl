// A function that ends without `return` gives 0 there.
// expect: 2 0
// fast: skip
float f(float p)
{
    if (p < 0.5)
        return 1.0;
    else if (p < 0.7)
        return 2.0;
}
void main()
{
    result[0] = f(0.6 * one);
    result[1] = f(0.8 * one);
}
