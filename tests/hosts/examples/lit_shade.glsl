void main()
{
    ivec2 p = invocation().xy;
    if (all(lessThan(p, shown_size())))
        shown_store(p, vec4(gbuffer_albedo(p).rgb * irradiance(p).x, 1.0));
}
