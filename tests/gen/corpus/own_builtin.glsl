// Functions of the body with names of built-in functions.
// expect: 2 3 6 9 5
float round(float x) { return floor(x + 0.5); }
float mod(float a, float b) { return a * b; }
float length(float x) { return x * x; }
float mix(float a, float b, float c) { return a + b; }
void main()
{
    result[0] = round(one * 1.7);
    result[1] = round(two + half_);
    result[2] = mod(two, three);
    result[3] = length(three);
    result[4] = mix(two, three, half_);
}
