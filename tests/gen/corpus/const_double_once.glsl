// Constants are computed in double precision and rounded once; what is live is computed in float.
// expect: 0.3 0.3 0.6666667 0.001
const float tenth = 0.1;
const float fifth = 0.2;
void main()
{
    result[0] = (tenth + fifth) * one;
    float a = tenth * one, b = fifth * one;
    result[1] = a + b;
    result[2] = (1.0 / 3.0 + 1.0 / 3.0) * one;
    result[3] = tenth * tenth * tenth * one;
}
