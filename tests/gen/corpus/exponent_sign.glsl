// An exponent's sign is not an operator, and e is a name, too.
// expect: 2.001 99 98 19
void main()
{
    float e = two;
    result[0] = 1e-3*one+e;
    result[1] = 1e+2-one;
    result[2] = 1e2-e;
    result[3] = e*1e1-one;
}
