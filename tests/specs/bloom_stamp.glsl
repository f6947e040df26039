void main()
{
    ivec2 p = ivec2(gl_FragCoord.xy);
    stamped = before(p) + after_sample(gl_FragCoord.xy / vec2(after_size()));
}
