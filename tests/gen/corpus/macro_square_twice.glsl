// The classic square, with and without parentheses.
// expect: 9 5 36 0.11111111
#define SQ(x) x * x
#define SQP(x) ((x) * (x))
void main()
{
    result[0] = SQP(one + two);
    result[1] = SQ(one + two);
    result[2] = SQP(two * three);
    result[3] = SQ(one / three);
}
