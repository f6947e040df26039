float sign_of(int x)
{
    if (x > 3)
        return 1.0;
    if (x <= 3)
        return -1.0;
}

void main()
{
    ivec2 p = invocation().xy;
    shown_store(p, vec4(sign_of(p.x)));
}
