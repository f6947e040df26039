void main()
{
    labels = uvec4(1);
}
