// Swizzles of results, of constructors and of sums.
// expect: 2 3 1 6
vec3 make() { return vec3(one, two, three); }
void main()
{
    result[0] = make().y;
    result[1] = (make() + vec3(0.0)).zyx.x;
    result[2] = vec4(make().xy, vec2(0.0)).rg.x;
    result[3] = (make() * make().zzz).yx[0];
}
