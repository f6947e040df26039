// A macro that evaluates its argument twice, and a function that does not.
// expect: 12 2 20 2
#define TWICE(x) (x + x)
int counter = 0;
float next()
{
    counter++;
    return float(counter) * 4.0;
}
float twice(float x)
{
    return x + x;
}
void main()
{
    result[0] = TWICE(next());
    result[1] = float(counter);
    counter = 0;
    float first = next() + next();
    result[2] = first + twice(next()) - 16.0;
    result[3] = float(counter) - one;
}
