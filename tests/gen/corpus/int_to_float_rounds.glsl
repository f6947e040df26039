// Large integers are rounded to the nearest float.
// expect: 16777216.0 2147483600.0 4294967000.0 16777216.0
void main()
{
    result[0] = float(16777217 * int(one));
    result[1] = float(2147483647 * int(one));
    result[2] = float(4294967167u * uint(one));
    result[3] = float(int(float(16777217 * int(one))));
}
