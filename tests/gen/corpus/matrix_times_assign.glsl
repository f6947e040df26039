// m *= n and v *= m.
// expect: 1 3 7 10
void main()
{
    mat2 m = mat2(one, 0.0, one, one);
    mat2 turn = mat2(one, one, 0.0, one);
    m *= turn;
    result[0] = m[0][1];
    result[1] = m[0][0] + m[1][0];
    vec2 v = vec2(three, two);
    v *= m;
    result[2] = v.x - one;
    mat2 n = turn;
    n *= n;
    n *= three;
    result[3] = n[0][1] + n[0][0] + n[1][1] - two;
}
