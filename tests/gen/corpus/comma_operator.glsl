// The comma evaluates both and is the right one.
// expect: 3 2 7 1
void main()
{
    float a = one, b = two;
    float c = (a = two, b = three, b);
    result[0] = c;
    result[1] = a;
    int i = 0;
    float list[3] = float[3](one, 7.0 * one, two);
    result[2] = list[(i++, i)];
    result[3] = float(i) * one;
}
