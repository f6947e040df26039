// Products of matrices and vectors from both sides; columns first.
// expect: 7 6 7 7 5 5 7
void main()
{
    mat2 a = mat2(one, two, three, one);
    mat2 b = mat2(one, two, three, one);
    mat2 c = a * b;
    result[0] = c[0][0];
    result[1] = c[1][0];
    result[2] = c[1][1];
    vec2 v = a * vec2(one, two);
    result[3] = v.x;
    vec2 w = vec2(one, two) * a;
    result[4] = w.x;
    result[5] = w.y;
    v = vec2(one, two);
    v = a * v;
    result[6] = v.x;
}
