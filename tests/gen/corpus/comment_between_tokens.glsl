// Comments part tokens, in expressions, calls and directives.
// expect: 0.33333334 3 2 1.5
#define /* a */ RATIO(/* x */ a, /* y */ b) /* of */ (a / b) // to the end
#if /* not */ 0 /* or */ || 1 // really
#define BRANCH 3.0
#else /* never */
#define BRANCH 4.0
#endif // 0 || 1
void main()
{
    result[0] = one/**// three;
    result[1] = BRANCH/* */*/* */one;
    result/* the third */[/* index */2/* */]/* */=/* */two/* */;
    result[3] = RATIO/* */(/* */three/* */,/* */two/* */);
}
