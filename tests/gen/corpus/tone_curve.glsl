// A curve for film tones, as a chain of macros.
// expect: 0.6163069 0.8037974 0.9537427
#define TONE_A 2.51
#define TONE_B 0.03
#define TONE_C 2.43
#define TONE_D 0.59
#define TONE_E 0.14
#define TONE_TOP(x) ((x) * (TONE_A * (x) + TONE_B))
#define TONE_BOTTOM(x) ((x) * (TONE_C * (x) + TONE_D) + TONE_E)
#define TONE(x) clamp(TONE_TOP(x) / TONE_BOTTOM(x), 0.0, 1.0)
void main()
{
    vec3 t = TONE(vec3(half_, one, three));
    result[0] = t.r;
    result[1] = t.g;
    result[2] = t.b;
}
