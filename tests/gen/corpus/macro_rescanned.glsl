// The result of a macro and the text behind it make the next call.
// expect: 6 6 24
#define TIMES(x) ((x) * three)
#define NAME TIMES
#define APPLY(f, x) f(x)
#define TWO two
void main()
{
    result[0] = NAME(two);
    result[1] = APPLY(TIMES, TWO);
    result[2] = APPLY(TIMES, APPLY(TIMES, TWO)) + TIMES (two);
}
