void main()
{
    if (invocation().x == 0)
        number[0] = 1u;
}
