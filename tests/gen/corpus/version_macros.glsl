// Predefined macros.
// expect: 1 1 1 3
void main()
{
#if __VERSION__ >= 460
    result[0] = one;
#else
    result[0] = 0.0;
#endif
#ifdef GL_core_profile
    result[1] = one;
#else
    result[1] = 0.0;
#endif
#if defined GL_ES || defined(VERTEX) || defined FRAGMENT
    result[2] = 0.0;
#else
    result[2] = one;
#endif
    int before = __LINE__;


    result[3] = float(__LINE__ - before) * one;
}
