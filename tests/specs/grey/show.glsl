void main()
{
    ivec2 p = invocation().xy;
    if (all(lessThan(p, picture_size())))
        picture_store(p, radiance(p));
}
