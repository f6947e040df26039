// Arrays are values: assigned, compared, handed over.
// expect: 1 0 9 1
float changed(float a[3]) { a[0] = 9.0; return a[0]; }
void main()
{
    float a[3] = float[](one, two, three);
    float b[3] = a;
    result[0] = float(a == b);
    b[1] = three;
    result[1] = float(a == b);
    result[2] = changed(a);
    result[3] = a[0];
}
