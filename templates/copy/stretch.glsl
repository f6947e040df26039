/* A picture of another size, filtered to that of the target. */
void main()
{
    picture = from_sample(gl_FragCoord.xy / vec2(frame.width, frame.height));
}
