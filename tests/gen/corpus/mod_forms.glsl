// mod of both signs, by vectors and by one number.
// expect: 1.5 0.5 0.25 1 1.5
void main()
{
    result[0] = mod(three + half_, two);
    result[1] = mod(-three - half_, two);
    result[2] = mod(vec2(2.25, one) * one, one).x;
    result[3] = mod(vec2(one, three), vec2(three, two)).y;
    result[4] = mod(5.5 * one, two);
}
