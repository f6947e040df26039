void main()
{
    plain = vec4(1.0);
}
