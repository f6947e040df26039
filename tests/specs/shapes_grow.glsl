void main()
{
    ivec3 p = invocation();
    if (all(lessThan(p, lookup_size())))
        lookup_store(p, lookup(p) + vec4(float(p.x + 3 * p.y + 9 * p.z + 1)));
}
