// A function-like macro without parameters is one only before a parenthesis.
// expect: 1 2 3 5
#define get() one
#define both(a, b) a b
float wrap(float x)
{
    return x;
}
#define wrap(x) wrap(x + one)
void main()
{
    float get = two;
    result[0] = get();
    result[1] = get;
    result[2] = wrap(two);
    result[3] = both(two, + three);
}
