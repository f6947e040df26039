// One name, many signatures.
// expect: 1 2 3 4 5 6
float kind(float x) { return 1.0; }
float kind(int x) { return 2.0; }
float kind(uint x) { return 3.0; }
float kind(bool x) { return 4.0; }
float kind(vec2 x) { return 5.0; }
float kind(float x, float y) { return 6.0; }
void main()
{
    result[0] = kind(one) * one;
    result[1] = kind(int(one)) * one;
    result[2] = kind(uint(one)) * one;
    result[3] = kind(one > two) * one;
    result[4] = kind(vec2(one)) * one;
    result[5] = kind(one, two) * one;
}
