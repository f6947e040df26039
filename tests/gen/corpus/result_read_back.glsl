// The output as a variable: read, changed in place, handed over.
// expect: 3 9 6
void halve(inout float x) { x /= two; }
void main()
{
    result[0] = three;
    result[1] = result[0] * result[0];
    result[2] = 12.0;
    halve(result[2]);
    result[0] *= one;
}
