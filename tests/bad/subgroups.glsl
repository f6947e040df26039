/* subgroupAdd in a comment is nothing. */
void main()
{
    sums[invocation().x] = subgroupMax(1u) + gl_SubgroupSize;
}
