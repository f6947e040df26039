void main()
{
    coarser = finer_sample(gl_FragCoord.xy / vec2(finer_size() / 2));
}
