// Slashes that divide beside slashes that comment.
// expect: 0.33333334 0.6666667 1.5
void main()
{
    float a = one / three; // / two
    result[0] = a;
    float b = two
        / // the operator stands alone
        three /* / one */
        ;
    result[1] = b;
    float c = three //* two
        * half_;
    result[2] = c;
}
