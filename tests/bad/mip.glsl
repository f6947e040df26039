void main()
{
    other = other_sample(gl_FragCoord.xy / 32.0);
}
