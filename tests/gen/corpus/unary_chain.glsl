// Signs and negations in a row.
// expect: 1 -2 0 3 -3
void main()
{
    result[0] = - -one;
    result[1] = -(+two);
    result[2] = float(!!!(one < two));
    result[3] = three * - - +one;
    result[4] = float(~int(two)) * one;
}
