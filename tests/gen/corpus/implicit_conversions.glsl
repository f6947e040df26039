// Integers become floats where a float is needed.
// expect: 3 2.5 4 7 1.5
float half_of(float x) { return x * 0.5; }
void main()
{
    float a = 3;
    result[0] = a * one;
    result[1] = half_of(int(two) + int(three));
    vec2 v = vec2(1, 2) * 2;
    result[2] = v.y * one;
    uint u = 7;
    result[3] = float(u) * one;
    result[4] = 3 / two;
}
