// sign and abs of floats and integers.
// expect: -1 0 1 3 2 -1
void main()
{
    result[0] = sign(-three);
    result[1] = sign(0.0 * one);
    result[2] = sign(half_);
    result[3] = abs(-three);
    result[4] = float(abs(-int(two)));
    result[5] = float(sign(ivec2(-int(three), 1)).x);
}
