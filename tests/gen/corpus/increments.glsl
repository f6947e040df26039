// Increments of ints, floats and vectors, before and behind.
// expect: 1 3 2 2 0.5 4 5
void main()
{
    int i = 1;
    int a = i++;
    int b = ++i;
    result[0] = float(a) * one;
    result[1] = float(b) * one;
    float f = one;
    ++f;
    result[2] = f--;
    result[3] = f + one;
    result[4] = (f -= half_);
    vec2 v = vec2(two, three);
    v++;
    result[5] = (v++).y;
    result[6] = v.y;
}
