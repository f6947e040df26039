// Types by macros and by macros of macros.
// expect: 6 3 2.5
#define real float
#define real3 vec3
#define REAL real
#define VEC(n) vec##n
REAL total(real3 v)
{
    return v.x + v.y + v.z;
}
void main()
{
    VEC(2) p = VEC(2)(one, two);
    result[0] = total(real3(one, two, three));
    result[1] = total(VEC(3)(p, 0.0));
    result[2] = REAL(p.y) + real(half_);
}
