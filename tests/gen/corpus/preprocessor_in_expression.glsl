// Directives between the operands of an expression.
// expect: 0.33333334 5 1
void main()
{
    float x = one /
#ifdef NEVER_DEFINED
        two
#else
        three
#endif
        ;
    result[0] = x;
    result[1] = two
#if 1
        + three
#endif
#if 0
        * 100.0
#endif
        ;
    result[2] = one *
#ifdef EXACT
        one
#else
        one
#endif
        ;
}
