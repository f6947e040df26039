void main()
{
    int i = invocation().x;
    if (i < bins)
        marks[i] = histogram[i].count * 3u + uint(i);
}
