void main()
{
    ivec2 p = invocation().xy;
    resources_store(p, uvec4(uint(p.x + p.y)));
}
