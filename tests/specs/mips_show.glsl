void main()
{
    ivec2 p = invocation().xy;
    float count = float(resources(ivec2(0)).x + program_fill[1]);
    picture_store(p, vec4(pyramid(p / 4).rgb, count / 255.0));
}
