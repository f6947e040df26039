// highp everywhere, and default precisions.
// expect: 1.5 3 2 65537
precision highp float;
precision highp int;
highp float scale(const in highp float x) { return x * 1.5; }
void main()
{
    highp vec2 v = vec2(one, two);
    result[0] = scale(v.x);
    result[1] = scale(v.y);
    highp int n = 2;
    result[2] = float(n) * one;
    result[3] = float(65536 + int(one));
}
