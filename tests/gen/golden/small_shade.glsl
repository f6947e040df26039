void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, lit_size())))
        return;
    vec3 sum = vec3(0.0);
    for (Lamp lamp : all_lamps) {
        sum += lamp.color * (lamp.power * max(dot(normal(p).xyz, lamp.position), 0.0));
    }
    lit_store(p, vec4(sum, depth(p)));
}
