void main()
{
    resources_store(invocation().xy, uvec4(9u));
}
