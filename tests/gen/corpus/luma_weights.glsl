// Luminance by constants, and a saturation around it.
// expect: 1.8596001 0.55700004 2.0702
const vec3 LUMA = vec3(0.2126, 0.7152, 0.0722);
#define LUMA_601 vec3(0.299, 0.587, 0.114)
float luma(vec3 c) { return dot(c, LUMA); }
void main()
{
    vec3 c = vec3(one, two, three);
    result[0] = luma(c);
    result[1] = dot(vec3(half_, half_, one), LUMA_601);
    result[2] = mix(vec3(luma(c)), c, 1.5).g;
}
