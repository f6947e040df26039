void main()
{
    ivec2 p = invocation().xy;
    if (all(lessThan(p, resources_size())))
        resources_store(p, uvec4(uint(p.x + p.y)));
}
