// Powers by macros in macros.
// expect: 8 16
#define P1(x) (x)
#define P2(x) (P1(x) * P1(x))
#define P3(x) (P2(x) * P1(x))
#define P4(x) (P2(P2(x)))
void main()
{
    result[0] = P3(two);
    result[1] = P4(one + one);
}
