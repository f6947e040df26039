// Quotients of matrices are by component.
// expect: 0.5 1 1.5 0.5 1 0.5 0.33333334 1
void main()
{
    mat2 m = mat2(one, two, three, one);
    mat2 q = m / mat2(two, two, two, two), r = one / m;
    result[0] = q[0].x;
    result[1] = q[0].y;
    result[2] = q[1].x;
    result[3] = q[1].y;
    result[4] = r[0].x;
    result[5] = r[0].y;
    result[6] = r[1].x;
    result[7] = r[1].y;
}
