void main()
{
    int i = invocation().x;
    if (i >= count)
        return;
    items[i].column = i * 3 % 32;
    items[i].height = 1 + i % 24;
    items[i].weight = uint(i * i % 13 + few);
}
