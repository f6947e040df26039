// Variables and parameters with the names of built-in functions.
// expect: 1 2 4 5 3
float step_by(float floor, float mix) { return floor + mix; }
void main()
{
    float dot = one, min = two;
    result[0] = dot;
    result[1] = min;
    vec2 normalize = vec2(three, one);
    result[2] = normalize.x + normalize.y;
    float sqrt = two, exp = three;
    result[3] = sqrt + exp;
    result[4] = step_by(one, two);
}
