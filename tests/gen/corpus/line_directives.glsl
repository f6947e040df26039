// Directives that change nothing of the result.
// expect: 1 2 3
#pragma optimize(on)
#pragma anything at all
#
# /* empty */
#line 100
void main()
{
    result[0] = one;
#line 200 1
    result[1] = two;
# line 7
    result[2] = three;
}
