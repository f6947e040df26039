// Macros without parentheses bind as their text does.
// expect: 3 7 1.5 5 1.6666667
#define DIV(a, b) a / b
#define SUM 1.0 + 2.0
#define HALF 1.0 / 2.0
#define AB one + two
void main()
{
    result[0] = AB;
    result[1] = SUM * three;
    result[2] = three / HALF;
    result[3] = three / AB;
    result[4] = DIV(one + two, three);
}
