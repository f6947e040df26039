void main()
{
    picture = vec4(1.0);
}
