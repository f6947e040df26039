void main()
{
    ivec2 p = invocation().xy;
    vec2 uv = (vec2(p) + 0.5) / vec2(fetched_size());
    fetched_store(p, vec4(unorm8_stored(p).r, unorm10_stored(p).r, unorm10_stored(p).a, unorm16_stored(p).r));
    shorts_store(p, vec4(snorm16_stored(p).r, 0.0, 0.0, 0.0));
    sampled_store(p, vec4(near8_sample(uv).r, near16_sample(uv).r, 0.0, 0.0));
}
