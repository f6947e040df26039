void main()
{
    ivec2 p = invocation().xy;
    picture_store(p, vec4(labels_sample(vec2(0))) + shadow_sample(vec2(0)) + light_map_compare(vec2(0), 0.0));
}
