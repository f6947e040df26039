void main()
{
    resources_store(ivec2(0), uvec4(9u));
}
