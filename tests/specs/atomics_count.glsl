void main()
{
    int i = invocation().x;
    if (i >= 1000)
        return;
    int column = i & 7;
    uint bit = 1u << (i >> 3 & 31);
    tally_atomicAdd(ivec2(column, 0), 1u);
    tally_atomicMin(ivec2(column, 1), uint(i));
    tally_atomicMax(ivec2(column, 2), uint(i));
    tally_atomicAnd(ivec2(column, 3), i < 100 ? ~bit : 0xffffffffu);
    tally_atomicOr(ivec2(column, 4), i < 100 ? bit : 0u);
    tally_atomicXor(ivec2(column, 5), bit * uint(i));
    cells_atomicAdd(ivec3(i & 1, i >> 1 & 1, i >> 2 & 1), uint(i));
    ends_atomicMin(ivec3(0, 0, i % 6), i % 6 < 3 ? -i : 2000); /* changes only what the next does not */
    ends_atomicMax(ivec3(0, 0, i % 6), i % 6 < 3 ? -2000 : i);
    /* Plain stores beside: validation 1.3.239 takes an image that is changed only atomically for one that is read. */
    if (i < 4) {
        if (i == 0)
            once_store(ivec2(4, 0), uvec4(3u));
        tally_store(ivec2(i, 6), uvec4(i));
        cells_store(ivec3(i & 1, i >> 1, 2), uvec4(i));
        ends_store(ivec3(1, 1, i), ivec4(i));
    }
    if (i != 500)
        return;
    uint before = once_atomicExchange(ivec2(0, 0), 7u);
    uint kept = once_atomicCompSwap(ivec2(1, 0), 6u, 8u);
    uint swapped = once_atomicCompSwap(ivec2(2, 0), 5u, 9u);
    once_atomicAdd(ivec2(3, 0), before + kept + swapped);
}
