void main()
{
    alone[gl_GlobalInvocationID.x] = 1;
}
