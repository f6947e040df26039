// saturate, lerp and frac as functions of the body.
// expect: 1 0 0.5 0.5
float saturate(float x) { return clamp(x, 0.0, 1.0); }
vec2 saturate(vec2 x) { return clamp(x, vec2(0.0), vec2(1.0)); }
float lerp(float a, float b, float t) { return a + (b - a) * t; }
float frac(float x) { return x - floor(x); }
void main()
{
    result[0] = saturate(two);
    result[1] = saturate(vec2(-one, half_)).x;
    result[2] = lerp(0.0, one, half_);
    result[3] = frac(two + half_);
}
