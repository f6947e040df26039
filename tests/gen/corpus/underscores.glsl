// Names with underscores and digits.
// expect: 1 2 3
float _(float _0) { return _0; }
void main()
{
    float _a_ = two, x1y2 = three;
    result[0] = _(one);
    result[1] = _a_;
    result[2] = x1y2;
}
