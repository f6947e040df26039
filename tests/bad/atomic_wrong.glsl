void main()
{
    tally_atomicAdd(ivec2(0), tally(ivec2(1)).x);
    shades_atomicMax(ivec2(0), 1u);
    labels_atomicOr(ivec2(0), 1);
}
