// Swizzles, fields and methods by macros.
// expect: 3 1 2 14
#define rg xy
#define LAST .z
#define COUNT(a) a.length()
#define SELF(v) dot(v, v)
void main()
{
    vec3 v = vec3(one, two, three);
    float list[2] = float[2](one, two);
    result[0] = v LAST;
    result[1] = v.rg.x;
    result[2] = float(COUNT(list));
    result[3] = SELF(v);
}
