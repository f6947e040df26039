void main()
{
    int i = invocation().x;
    if (i < 4096)
        early[i] = uint(i);
}
