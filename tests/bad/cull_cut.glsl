void main()
{
    slabs[invocation().x] = float(invocation().x);
}
