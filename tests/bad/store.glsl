void main()
{
    ivec2 p = invocation().xy;
    other_store(p, vec4(0.0));
    picture_store(p, other_sample(vec2(p)));
}
