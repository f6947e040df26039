void main()
{
    picture_store(invocation().xy, vec4(float(number[0]) / 9999.0));
}
