void main()
{
    int i = invocation().x;
    if (i >= cases)
        return;
    vec4 a = inputs[i].a, b = inputs[i].b, s = inputs[i].s;
    elementary[i].waves = vec4(sin(s.x * PI), cos(s.y * PI), exp(s.z * 8.0), log(abs(a.x)));
    elementary[i].powers = vec4(pow(abs(a.x), s.y), exp2(s.w * 8.0), log2(abs(a.y)), tan(s.x));
    elementary[i].roots = vec4(sqrt(abs(a.x)), inversesqrt(abs(a.y)), sqrt(abs(b.x)), inversesqrt(abs(b.y)));
    elementary[i].steps = vec4(mod(a.x, b.x), fract(a.y), smoothstep(-0.75, 0.5, s.x), smoothstep(-1.0, 2.0, s.y));
}
