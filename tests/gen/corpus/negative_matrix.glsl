// The sign of a matrix, and increments.
// expect: -1 -2 3
void main()
{
    mat2 m = -mat2(one, two, three, one);
    result[0] = m[0][0];
    result[1] = m[0][1];
    m = -m;
    m--;
    m++;
    result[2] = m[1][0];
}
