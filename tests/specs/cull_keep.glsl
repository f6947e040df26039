bool keeps_triangle(vec3 a, vec3 b, vec3 c, Slab slab)
{
    return max(max(a.y, b.y), c.y) >= slab.low && min(min(a.y, b.y), c.y) <= slab.high;
}
