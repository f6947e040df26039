// Conditions in conditions, in a part that is left out.
// expect: 3 4
#if 0
#if 1
#define PICK one
#else
#define PICK two
#endif
#else
#if defined(COMPUTE) && !defined(FRAGMENT)
#if (2 * 3 == 6) && (7 / 2 == 3) && (1 << 3 > 7)
#define PICK three
#else
#error arithmetic of directives
#endif
#endif
#endif
#if 0
# error not reached
' an apostrophe in what is left out
#endif
void main()
{
    result[0] = PICK;
    result[1] = PICK + one;
}
