// A macro builds a family of functions.
// expect: 4 9 6 0.33333334 7
#define UNARY(name, expression) float name(float x) { return expression; }
UNARY(square, x * x)
UNARY(third, x / 3.0)
UNARY(plus_six, x + 6.0)
#define OVERLOADED(T) T doubled(T x) { return x + x; }
OVERLOADED(float)
OVERLOADED(vec2)
OVERLOADED(int)
void main()
{
    result[0] = square(two);
    result[1] = square(three);
    result[2] = doubled(vec2(one, three)).y;
    result[3] = third(one);
    result[4] = plus_six(one) + float(doubled(4)) - 8.0;
}
