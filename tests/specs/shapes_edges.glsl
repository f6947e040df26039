/* Beyond the edge, and on it. */
void main()
{
    if (invocation().xy != ivec2(0))
        return;
    edges_store(ivec2(0, 0), fog_none_sample(vec3(-1.0)));
    edges_store(ivec2(1, 0), fog_black_sample(vec3(0.5, 2.0, 0.5)));
    edges_store(ivec2(2, 0), fog_white_sample(vec3(0.5, 0.5, -1.0)));
    edges_store(ivec2(3, 0), fog_white_sample(vec3(0.0, 0.5 / 6.0, 0.1)));
    edges_store(ivec2(4, 0), mask_sample(vec2(2.0)));
    edges_store(ivec2(5, 0), vec4(front_compare(vec2(-1.0), 0.9), front_compare(vec2(0.5), 0.9), 0.0, 0.0));
}
