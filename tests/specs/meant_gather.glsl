void main()
{
    float unset;
    if (invocation().x < 8)
        barrier();
    loose[0] = 1.0 + zero * (loose[1] + unset);
}
