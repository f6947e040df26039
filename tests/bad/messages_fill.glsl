float weight(float x)
{
    return x;
}

void main()
{
    picture_store(ivec2(invocation().xy), vec4(weight(1.0)));
}
