void main()
{
    ivec2 p = invocation().xy;
    vec2 uv = (vec2(p) + 0.3) / 8.0;
    seen_store(p, fog_sample(vec3(uv, 0.4)) + slope_sample(uv));
}
