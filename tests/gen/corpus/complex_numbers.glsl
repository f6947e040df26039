// Complex numbers by macros and functions.
// expect: -3 4 0.44 0.08
#define cx vec2
#define cx_mul(a, b) cx((a).x * (b).x - (a).y * (b).y, (a).x * (b).y + (a).y * (b).x)
cx cx_div(cx a, cx b) { return cx(dot(a, b), a.y * b.x - a.x * b.y) / dot(b, b); }
void main()
{
    cx z = cx(one, two);
    cx square = cx_mul(z, z);
    result[0] = square.x;
    result[1] = square.y;
    cx q = cx_div(z, cx(three, 4.0 * one));
    result[2] = q.x;
    result[3] = q.y;
}
