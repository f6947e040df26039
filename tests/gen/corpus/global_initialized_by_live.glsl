// Globals that begin with live values.
// expect: 2 6 0.33333334
float doubled = two;
vec2 pair = vec2(two, three);
float third = one / three;
void main()
{
    result[0] = doubled;
    result[1] = pair.x * pair.y;
    result[2] = third;
}
