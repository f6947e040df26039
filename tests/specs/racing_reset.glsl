void main()
{
    counter[0] = 0u;
}
