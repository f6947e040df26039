/* Interleaved shading, gather: from the split order back to pixels. */
void main()
{
    ivec2 size = irradiance_size();
    ivec2 p = invocation().xy;
    if (p.x >= size.x || p.y >= size.y)
        return;
    irradiance_store(p, split_irradiance(pattern_split(p, size)));
}
