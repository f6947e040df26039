void main()
{
    ivec2 p = invocation().xy;
    picture_store(p, other(p));
}
