// A macro that begins with a minus sign, in and after other operators.
// expect: -1 3 9 7
#define NEG -one
#define SHIFTED -two + three
void main()
{
    result[0] = NEG;
    result[1] = one - -two;
    result[2] = two -SHIFTED + two;
    result[3] = NEG * SHIFTED + two;
}
