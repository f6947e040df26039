float doubled(float x)
{
    return 2.0 * x;
}
