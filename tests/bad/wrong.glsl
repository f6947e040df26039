void main()
{
    ivec2 p = invocation().xy;
    picture_store(p, colour);
    if (any(lessThan(p, pictur_size())))
        picture_store(p, 1u);
    uint n = heigt + picture(p).r;
    n = picture(p).r;
    p += heigt_size();
}
