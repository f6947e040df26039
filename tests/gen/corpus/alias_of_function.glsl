// Aliases of a port from HLSL.
// expect: 1.25 0.5 1 0.75
#define lerp mix
#define frac fract
#define saturate(x) clamp(x, 0.0, 1.0)
#define float2 vec2
#define float4x4 mat4
#define mul(a, b) ((a) * (b))
#define static
#define rsqrt inversesqrt
static float2 pair(float x)
{
    return float2(x, x * half_);
}
void main()
{
    result[0] = lerp(one, two, 0.25);
    result[1] = frac(two + half_);
    result[2] = saturate(three);
    float4x4 m = float4x4(half_);
    result[3] = saturate(mul(m, vec4(one + half_)).x) * pair(one).x;
}
