/* Operations that `precise` does not reach in GLSL text. Compilers that may would multiply 0.1 by 0.3. */
vec4 kept(vec4 x)
{
    return x;
}

void main()
{
    int i = invocation().x;
    if (i >= cases)
        return;
    vec4 a = inputs[i].a, b = inputs[i].b, s = inputs[i].s;
    mat4 m = mat4(a, b, s, a.wzyx);
    places[i].argument = kept(vec4(0.1 * a.xy * 0.3, 0.1 * a.zw * 0.3 - s.xy));
    places[i].matrices = kept(vec4(m * transpose(m) * m * s));
    places[i].divided = a / (0.1 * b * 0.3);
    for (int k = 0; k < 4; k++) /* Mesa marks what follows the assignment to a marked variable */
        places[i].compared[k] = 0.1 * a[k] * 0.3 == 0.1 * 0.3 * a[k] ? 1.0 : 0.0;
    for (int k = 0; k < 4; k++)
        if (0.1 * a[k] * 0.3 == 0.1 * 0.3 * a[k])
            places[i].decided[k] = 1.0;
        else
            places[i].decided[k] = 0.0;
}
