/* Points on a line through the unit square. */
void main()
{
    int i = invocation().x;
    if (i < points)
        places[i] = vec2(float(i) + 0.5, 0.25 * float(i)) / float(points);
}
