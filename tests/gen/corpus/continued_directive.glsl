// Directives over several lines.
// expect: 4 2
#if defined(NOTHING) || \
    !defined(COMPUTE) || \
    0
#define \
    CHOICE 3.0
#else
#define \
    CHOICE \
    4.0
#endif
#ifdef \
    CHOICE
#define GIVEN two
#else
#define GIVEN three
#endif
void main()
{
    result[0] = CHOICE * one;
    result[1] = GIVEN;
}
