// Conversions cut towards zero.
// expect: 1 -1 3 0 -2
void main()
{
    result[0] = float(int(one + half_));
    result[1] = float(int(-one - half_));
    result[2] = float(uint(three + 0.99 * one));
    result[3] = float(int(-half_));
    result[4] = float(ivec2(vec2(-two - half_, one)).x);
}
