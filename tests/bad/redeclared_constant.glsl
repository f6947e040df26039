void main()
{
    float half_width = 2.0;
    other_store(invocation().xy, picture(ivec2(0)) * half_width);
}
