void main()
{
    ivec3 p = invocation();
    if (all(lessThan(p, coarser_size())))
        coarser_store(p, finer_sample((vec3(p) + 0.5) / vec3(coarser_size())));
}
