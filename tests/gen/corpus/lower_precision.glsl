// Lower precision allows less, and gives the same as highp.
// expect: 0.36155784 0.20845649
// fast: skip
mediump vec2 f(mediump vec2 p)
{
    mediump vec2 p3 = p * p * p;
    return p - p3 * (1.0 / 6.0);
}
void main()
{
    mediump vec2 v = f(vec2(0.37 * one, 0.21 * one));
    result[0] = v.x;
    result[1] = v.y;
}
