void main()
{
    int i = invocation().x;
    to[places[i]] = from[i];
}
