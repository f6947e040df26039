void main()
{
    ivec3 p = invocation();
    if (all(lessThan(p.xy, probes_size())) && p.z < 12)
        probes_store(p, vec4(sky(ivec3(2 * p.xy, p.z % 6)).xyz / 16.0, float(p.z) / 12.0));
}
