void main()
{
    pyramid = pyramid_sample(gl_FragCoord.xy / 16.0);
}
