/* Interleaved shading, split (Segovia et al. 2006): the pixels of a class side by side. */
void main()
{
    ivec2 size = gbuffer_position_size();
    ivec2 p = invocation().xy;
    if (p.x >= size.x || p.y >= size.y)
        return;
    ivec2 q = pattern_split(p, size);
    split_position_store(q, gbuffer_position(p));
    split_normal_store(q, gbuffer_normal(p));
}
