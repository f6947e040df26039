void main()
{
    int i = invocation().x;
    if (i < 32)
        halves[2 * i] = uint(i);
}
