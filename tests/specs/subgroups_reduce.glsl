/* One of each subgroup has the sum of its numbers, the others 0. */
void main()
{
    uint i = uint(invocation().x);
#ifndef EXACT
    uint sum = subgroupAdd(i);
    sums[i] = subgroupElect() ? sum : 0u;
#else
    sums[i] = i;
#endif
}
