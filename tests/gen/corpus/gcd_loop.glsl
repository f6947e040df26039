// Two values that change together.
// expect: 6 1
int gcd(int a, int b)
{
    while (b != 0) {
        int t = a % b;
        a = b, b = t;
    }
    return a;
}
void main()
{
    result[0] = float(gcd(48 * int(one), 18));
    result[1] = float(gcd(int(three), int(two)));
}
