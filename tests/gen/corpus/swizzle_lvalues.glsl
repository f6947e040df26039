// Swizzles on the left, in another order, of elements and of swizzles.
// expect: 3 1 2 5 6 9
void main()
{
    vec3 v = vec3(one, two, three);
    v.zxy = v;
    result[0] = v.y;
    v = vec3(one, two, three);
    v.xy = v.yx;
    result[1] = v.y;
    result[2] = v.x;
    vec4 list[2];
    list[1].wy = vec2(5.0, 6.0) * one;
    result[3] = list[1].w;
    result[4] = list[1].y;
    vec4 w = vec4(one);
    w.xyz.yx.x = 9.0 * one;
    result[5] = w.y;
}
