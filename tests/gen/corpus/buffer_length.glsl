// The length of the output, as a method and as a name.
// expect: 6 5 4 4
void main()
{
    result[0] = float(result.length() + 2) * one;
    result[1] = float(result_count) + one;
    result[result.length() - 2] = 4.0 * one;
    result[3] = result[2];
}
