// A subgroup operation, with its extension.
// refused: subgroupAdd
// refused: exactness: fast
#extension GL_KHR_shader_subgroup_arithmetic : enable
void main()
{
    result[0] = subgroupAdd(one);
}
