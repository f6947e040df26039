// A function that returns nothing on one path.
// refused: `f`
// refused: return
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
}
