void main()
{
    finer = coarser_sample(gl_FragCoord.xy / vec2(coarser_size() * 2)) * 0.5;
}
