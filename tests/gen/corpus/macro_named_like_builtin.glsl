// Macros that have names of built-in functions.
// expect: 1 3 1 -2 10
#define round(X) floor((X) + 0.5)
#define mod(a, b) ((a) - (b))
#define pow(a, b) ((a) * (b))
void main()
{
    result[0] = round(one * 0.5);
    result[1] = round(two + 0.5);
    result[2] = mod(three, two);
    result[3] = mod(one, three);
    result[4] = pow(pow(two, two), two + half_);
}
