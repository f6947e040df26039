// Operators before and behind the backslash of continued lines.
// expect: 0.33333334 6 2.3333333 3
#define QUOTIENT(x) (x / \
    three)
#define PRODUCT(x, y) (x \
    * \
    y)
void main()
{
    result[0] = QUOTIENT(one);
    result[1] = PRODUCT(two, three);
    result[2] = one / \
        three + \
        two;
    result[3] = o\
ne + tw\
o;
}
