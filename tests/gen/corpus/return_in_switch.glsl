// Every path of a switch returns.
// expect: 10 20 30 30
float pick(int k)
{
    switch (k) {
    case 0:
        return 10.0 * one;
    case 1: {
        float x = two * 10.0;
        return x;
    }
    case 2:
    default:
        return 30.0 * one;
    }
}
void main()
{
    for (int k = 0; k < 4; k++)
        result[k] = pick(k);
}
