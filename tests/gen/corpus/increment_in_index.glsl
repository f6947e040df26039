// Indices with side effects, on both sides.
// expect: 1 2 3 40 3
void main()
{
    float from[3] = float[3](one, two, three), to[3];
    int i = 0, j = 0;
    to[j++] = from[i++];
    to[j++] = from[i++];
    to[j++] = from[i++];
    result[0] = to[0];
    result[1] = to[1];
    result[2] = to[2];
    int k = 2;
    to[k--] = 40.0 * one;
    result[3] = to[2];
    result[4] = float(i) * one;
}
