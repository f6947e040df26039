void main()
{
    vec2 uv = gl_FragCoord.xy / vec2(half_width, half_height);
    halo = lit_sample(uv) * 0.5;
}
