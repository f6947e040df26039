/* Directions of a spiral: multiples of the golden angle. */
void main()
{
    int k = invocation().x;
    if (k >= samples)
        return;
    float angle = 2.39996323 * float(k);
    taps[k].direction = vec2(cos(angle), sin(angle));
}
