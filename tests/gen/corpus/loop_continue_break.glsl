// continue and break, and the counter behind the loop.
// expect: 25 9 10
void main()
{
    float odd = 0.0;
    int i;
    for (i = 0; ; i++) {
        if (i % 2 == 0)
            continue;
        if (i > 9)
            break;
        odd += float(i) * one;
    }
    result[0] = odd;
    float last = 0.0;
    for (int j = 0, k = 10; j < k; ++j, --k)
        last = float(j + k - 1);
    result[1] = last * one;
    int n = 0;
    while (true) {
        if (++n >= 10)
            break;
    }
    result[2] = float(n) * one;
}
