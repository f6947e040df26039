// Numbers and vectors in one operation.
// expect: 0.6666667 4 1.5 2
void main()
{
    vec2 v = two / vec2(three, one);
    result[0] = v.x;
    v = vec2(one, two) + two;
    result[1] = v.y;
    v = vec2(three) / two;
    result[2] = v.y;
    ivec2 i = 7 / ivec2(2, int(three));
    result[3] = float(i.y);
}
