void main()
{
    ivec2 p = invocation().xy;
    if (all(lessThan(p, picture_size())))
        picture_store(p, vec4(float(number[0]) / 9999.0));
}
