// Colours and texture coordinates name the same components.
// expect: 1 2 3 22 4
void main()
{
    vec4 c = vec4(one, two, three, 4.0);
    result[0] = c.r;
    result[1] = c.t;
    result[2] = c.bbb.z;
    c.gb += c.rr * 10.0 * two;
    result[3] = c.y;
    result[4] = c.abgr.s;
}
