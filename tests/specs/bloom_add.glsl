void main()
{
    ivec2 p = invocation().xy;
    vec2 uv = (vec2(p) + 0.5) / vec2(finer_size());
    if (all(lessThan(p, finer_size())))
        finer_store(p, finer(p) + coarser_sample(uv) * 0.5);
}
