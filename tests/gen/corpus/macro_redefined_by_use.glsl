// A macro in a macro is looked up where the outer one is used.
// expect: 7 11
#define INNER 3.0
#define OUTER (INNER + 4.0)
float now()
{
    return OUTER * one;
}
#undef INNER
#define INNER 7.0
void main()
{
    result[0] = now();
    result[1] = OUTER * one;
}
