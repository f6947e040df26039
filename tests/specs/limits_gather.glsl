void main()
{
    if (gl_GlobalInvocationID == uvec3(0))
        ends[0] = ends[1] = ends[2] = ends[3] = gl_WorkGroupSize.x;
}
