// Copies in and out: what is aliased changes after the call.
// expect: 1 4 3 2
float g = 1.0;
float see(inout float x)
{
    x += three;
    return g;
}
void swap(inout float a, inout float b) { float t = a; a = b; b = t; }
void main()
{
    g = one;
    result[0] = see(g);
    result[1] = g;
    vec2 v = vec2(two, three);
    swap(v.x, v.y);
    result[2] = v.x;
    result[3] = v.y;
}
