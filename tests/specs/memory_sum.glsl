void main()
{
    int i = invocation().x;
    if (i >= 32)
        return;
    uint sum = 0u;
    for (int k = 0; k < 128; ++k)
        sum += early[128 * i + k];
    sums[i] = sum;
}
