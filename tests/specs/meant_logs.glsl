void main()
{
    int i = invocation().x;
    level[i] = max(log(float(i) + zero), 0.0);
}
