void main()
{
    ivec3 p = invocation();
    if (p.z == 0 && all(lessThan(p.xy, mask_size())))
        mask_store(p.xy, vec4(1.0));
    if (all(lessThan(p, lookup_size())))
        lookup_store(p, (frame.first == 1u ? vec4(0.0) : lookup(p)) + vec4(float(p.x + 3 * p.y + 9 * p.z + 1)));
}
