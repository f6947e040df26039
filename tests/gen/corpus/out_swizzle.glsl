// A swizzle in another order as an out argument.
// expect: 7 8 3 2
void fill(out vec2 p) { p = vec2(7.0, 8.0) * one; }
void exchange(inout vec2 p) { p = p.yx; }
void main()
{
    vec4 v = vec4(0.0);
    fill(v.wx);
    result[0] = v.w;
    result[1] = v.x;
    vec4 w = vec4(one, two, three, one);
    exchange(w.yz);
    result[2] = w.y;
    result[3] = w.z;
}
