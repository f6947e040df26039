void main()
{
    ivec2 p = invocation().xy;
    pyramid_store(p, pyramid(p * 2));
}
