// An object-like macro takes the name of a built-in function for another one.
// expect: 5 12 2
#define sqrt plus_three
#define exp2(x) x * 4.0
float plus_three(float x)
{
    return x + 3.0;
}
void main()
{
    result[0] = sqrt(two);
    result[1] = exp2(three);
    result[2] = exp2(one) - plus_three(two) + three;
}
