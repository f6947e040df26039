// dot adds its products from left to right.
// expect: 0.70000005 0.14000002 16777216.0
void main()
{
    vec4 a = vec4(0.1, 0.2, 0.3, 0.4) * one, b = vec4(0.5, 0.6, 0.7, 0.8) * one;
    result[0] = dot(a, b);
    result[1] = dot(a.xyz, a.xyz);
    result[2] = dot(vec3(16777216.0, 1.0, 1.0) * one, vec3(one));
}
