void main()
{
    uint sum = 0u;
    for (uint v : a)
        sum += v + b + d;
    picture_store(invocation().xy, vec4(sum));
}
