// A variable with the name of a function.
// expect: 6 4
float gain(float x) { return x * 2.0; }
float apply(float x)
{
    float doubled = gain(x);
    float gain = 1.0;
    return doubled * gain;
}
void main()
{
    result[0] = apply(three);
    float length = two;
    result[1] = length * length;
}
