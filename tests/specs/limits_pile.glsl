void main()
{
    stack_store(ivec3(0), uvec4(1u));
}
