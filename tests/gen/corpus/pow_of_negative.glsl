// Squares of negative numbers by pow, as drivers give them.
// expect: 4 1 9
void main()
{
    result[0] = pow(-two, 2.0);
    vec2 v = pow(vec2(-one, -three), vec2(2.0));
    result[1] = v.x;
    result[2] = v.y;
}
