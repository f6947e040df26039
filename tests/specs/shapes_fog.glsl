void main()
{
    ivec3 p = invocation();
    if (any(greaterThanEqual(p, fog_size())))
        return;
    fog_store(p, vec4(vec3(p) / vec3(fog_size()), float((p.x ^ p.y ^ p.z) & 1)));
}
