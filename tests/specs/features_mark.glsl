void main()
{
    int i = invocation().x;
#if FACTOR % 2 == 1 && BIAS < 0
    if (i < bins)
        marks[i] = histogram[i].count * uint(FACTOR) + uint(i);
#endif
}
