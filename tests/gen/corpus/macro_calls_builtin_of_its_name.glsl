// A macro that calls the built-in function of its own name.
// expect: 6 9 2
#define max(a, b) (2.0 * max(a, b))
#define sqrt(x) (sqrt(x) + 1.0)
void main()
{
    result[0] = max(two, three);
    result[1] = sqrt(two * 32.0);
    result[2] = sqrt(one);
}
