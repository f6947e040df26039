void main()
{
    views[invocation().x] = count;
}
