void main()
{
    sums[invocation().x] = 1u;
}
