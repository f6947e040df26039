void main()
{
    ivec2 p = invocation().xy;
    other_store(p, picture(p));
}
