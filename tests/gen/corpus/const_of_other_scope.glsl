// A constant of a closed block or another function is not meant.
// expect: 2 15 5 12
float f() { const float k = 2.0; return k * one; }
float g(float p) { float a = p, k = p * 5.0; return k * 3.0; }
float h(float k) { float r; { const float k = 2.0; r = k; } return r + k * 3.0; }
void main()
{
    result[0] = f();
    result[1] = g(one);
    result[2] = h(one);
    float k = three;
    for (int i = 0; i < 1; i++) {
        const float k = 9.0;
        result[3] = k * one;
    }
    result[3] += k;
}
