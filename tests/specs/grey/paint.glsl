void main()
{
    ivec2 p = invocation().xy;
    if (all(lessThan(p, radiance_size())))
        radiance_store(p, vec4(vec3(level), 1.0));
}
