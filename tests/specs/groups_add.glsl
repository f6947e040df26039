void main()
{
    uint total = 0u;
    if (invocation().x > 0)
        return;
    for (int i = 0; i < count; i++)
        total += list[i].weight;
    sum[0] = total;
}
