void main()
{
    list[0] = 1u;
}
