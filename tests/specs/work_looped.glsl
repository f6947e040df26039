void main()
{
    int k = min(invocation().x, 999);
    float sum = 0.0;
    for (int i = 0; i < 10; i++) {
        for (int stride = 4; stride > 0; stride /= 2)
            sum = sum * 0.5 + 1.0; /* 10 x 3 x 2 */
        int j = 0;
        for (; j < 2; j++)
            sum += 1.0; /* 10 x 2 */
    }
    for (uint i = 0u; i <= uint(2 * rows); i += 3u)
        sum += 0.25; /* once for every three of 2 rows + 1 */
    for (float v : some) {
        sum += v; /* taps */
    }
    for (int i = 0; i < k; i++)
        sum += 1.0; /* 1: each invocation differs */
    int at = 0;
    for (int i = 0; i < 2; i++)
        for (; at < 8; at++)
            sum += 1.0; /* 2: the inner loop does not start anew */
    if (k == invocation().x) /* others repeat the last */
        sums[k] = sum;
}
