// Built-in variables of compute stages.
// expect: 0 1 1 0
void main()
{
    result[0] = float(gl_GlobalInvocationID.x) * one;
    result[1] = float(gl_WorkGroupSize.x * gl_NumWorkGroups.x) * one;
    result[2] = float(gl_WorkGroupSize.z) * one;
    result[3] = float(gl_LocalInvocationIndex + uint(invocation().x));
}
