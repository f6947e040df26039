// Assignments as operands.
// expect: 6 12 3 9
void main()
{
    float a = one, b = two, c;
    c = a += b *= two + half_;
    result[0] = c;
    c *= b = two;
    result[1] = c;
    float d = (a = three);
    result[2] = d;
    result[3] = (d *= d);
}
