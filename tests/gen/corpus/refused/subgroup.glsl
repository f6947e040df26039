// A subgroup operation, without its extension.
// refused: subgroupAdd
// refused: exactness: fast
void main()
{
    result[0] = subgroupAdd(one);
}
