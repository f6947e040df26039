// Quotients in indices, conditions, arguments, initialisers and returns.
// expect: 2 0.33333334 3 0.6666667 1 2
float third(float x) { return x / three; }
void main()
{
    float list[3] = float[](one, two, three / one);
    result[0] = list[int(three / two)];
    result[1] = third(third(three));
    for (float x = three; x / two > one; x -= one)
        result[2] = x;
    if (one / three < two / three)
        result[3] = one * two / three;
    vec2 v = vec2(one / three, two / three);
    result[4] = v.x + v.y;
    switch (int(6.0 / three)) {
    case 2: result[5] = two; break;
    default: result[5] = 0.0;
    }
}
