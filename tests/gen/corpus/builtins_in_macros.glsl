// Built-in functions and quotients inside of macros.
// expect: 2 2.236068 2 0.33333334 1
#define BLEND(a, b) mix(a, b, half_)
#define LEN(x, y) sqrt((x) * (x) + (y) * (y))
#define CLAMPED(x) clamp((x), one, two)
#define INVERSE(x) (1.0 / (x))
#define FRACT(x) (fract(x) + half_)
void main()
{
    result[0] = BLEND(one, three);
    result[1] = LEN(one, two);
    result[2] = CLAMPED(three);
    result[3] = INVERSE(three);
    result[4] = FRACT(two + half_);
}
