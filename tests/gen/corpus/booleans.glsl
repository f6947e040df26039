// Bools: operators, conversions, vectors.
// expect: 1 0 1 1 3
void main()
{
    bool a = one < two, b = bool(0.0 * one), c = bool(int(two));
    result[0] = float(a && !b);
    result[1] = float(a ^^ c);
    result[2] = float(a == c);
    result[3] = float(b != a || b);
    bvec3 v = bvec3(a, b, c);
    v.y = !v.y;
    result[4] = float(int(v.x) + int(v.y) + int(v.z));
}
