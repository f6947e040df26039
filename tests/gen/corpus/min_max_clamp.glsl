// min, max and clamp of floats, integers and vectors with numbers.
// expect: 1 3 2 2 -5 3
void main()
{
    result[0] = min(one, three);
    result[1] = max(vec2(one, three), two).y;
    result[2] = clamp(three, one, two);
    result[3] = max(vec2(one, three), two).x;
    result[4] = float(min(-5 * int(one), 2));
    result[5] = float(clamp(uint(three) + 4u, 1u, uint(three)));
}
