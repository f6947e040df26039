/* subgroupAdd in a comment is nothing, nor is it in text that the preprocessor leaves out. */
#ifdef WAVES
uint sum(uint x) { return subgroupAdd(x); }
#endif

void main()
{
    sums[invocation().x] = subgroupMax(1u) + gl_SubgroupSize;
}
