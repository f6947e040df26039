void main()
{
    ivec2 p = invocation().xy;
    vec2 uv = (vec2(p) + 0.5) / 64.0;
    picture_store(p, vec4(glow(p).rgb * 0.25 + trail_sample(vec3(uv, 1.0)).rgb * 0.125 + stamped(p / 4).rgb * 0.0625, 1.0));
}
