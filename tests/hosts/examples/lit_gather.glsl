void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, irradiance_size())))
        return;
    vec3 position = gbuffer_position(p).xyz, normal = gbuffer_normal(p).xyz;
    float sum = 0.0;
    for (uint i = 0u; i < lamps.length(); i++)
        sum += lamps[i].power * max(dot(normal, lamps[i].position - position), 0.0);
    irradiance_store(p, vec4(gain * sum));
}
