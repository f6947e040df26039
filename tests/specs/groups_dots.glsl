void main()
{
    int i = invocation().x;
    if (i >= count)
        return;
    items[i].place = ivec2(i * 7 % 32, i * 5 % 24);
    items[i].weight = uint(i * i % 11 + few);
}
