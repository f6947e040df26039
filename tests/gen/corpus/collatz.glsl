// Steps of a sequence of integers.
// expect: 16 111
int steps(int n)
{
    int count = 0;
    while (n != 1) {
        n = (n & 1) == 0 ? n >> 1 : 3 * n + 1;
        count++;
    }
    return count;
}
void main()
{
    result[0] = float(steps(7 * int(one)));
    result[1] = float(steps(27 * int(one)));
}
