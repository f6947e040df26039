// Macros without text: qualifiers of other languages, and marks.
// expect: 6 1 2
#define UNIFORM
#define HIGHP
#define CONST const
#define NOTHING(x)
HIGHP float f(CONST in HIGHP float x)
{
    NOTHING(this text goes away)
    return x * two;
}
#undef NOTHING
#define NOTHING
void main()
{
    UNIFORM HIGHP float y = f(three) NOTHING;
    result[0] = y;
    CONST HIGHP float c = 1.0;
    result[1] = c * one;
    result[2] = NOTHING two NOTHING;
}
