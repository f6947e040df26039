void main()
{
    ivec3 p = invocation();
    if (any(greaterThanEqual(p, fog_size())))
        return;
    fog_store(p, vec4(vec3(p) * 0.37, 1.0));
    if (p.z == 0)
        plain_store(p.xy, vec4(vec3(p) * 0.37, 1.0));
}
