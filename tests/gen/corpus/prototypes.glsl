// Functions declared before and after use, with unnamed parameters.
// expect: 9 5
float later(float, float);
float unused(float);
float early(float x) { return later(x, x); }
void main()
{
    result[0] = early(three);
    result[1] = later(two + half_, two);
}
float later(float a, float b) { return a * b; }
