// A function that returns an array; an index behind the call.
// expect: 4 9 3 2
float[3] squares(float x) { return float[3](x, x * x, x * x * x); }
void main()
{
    result[0] = squares(two)[1];
    result[1] = squares(three)[int(one)];
    result[2] = float(squares(one).length()) * one;
    float all[] = squares(two);
    result[3] = all[0];
}
