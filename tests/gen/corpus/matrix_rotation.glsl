// A turn by a right angle, and a chain of transforms without parentheses.
// expect: -2 1 -3 2
mat2 quarter() { return mat2(0.0, 1.0, -1.0, 0.0) * one; }
void main()
{
    vec2 p = quarter() * vec2(one, two);
    result[0] = p.x;
    result[1] = p.y;
    mat3 shift = mat3(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, one, two, 1.0);
    mat3 turn = mat3(quarter());
    vec2 q = (turn * shift * vec3(one, one, one)).xy;
    result[2] = q.x;
    result[3] = q.y;
}
