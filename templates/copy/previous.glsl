/* What an image holds at the end of a frame, for the next one. */
void main()
{
    to = from(ivec2(gl_FragCoord.xy));
}
