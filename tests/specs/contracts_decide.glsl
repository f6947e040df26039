/* The nearer of two centres, and how much nearer; the side of a line, and how far off it. */
void main()
{
    int i = invocation().x;
    if (i >= points)
        return;
    float first = length(places[i] - vec2(0.25, 0.0));
    float second = length(places[i] - vec2(0.75, 0.25));
    labels[i] = second < first ? 1 : 0;
    margins[i].mass = first + second;
    margins[i].margin = abs(second - first);
    sides[i] = places[i].x > 0.5 ? 1u : 0u;
    side_margins[i] = abs(places[i].x - 0.5);
    sums[i] = (places[i].x + places[i].y) / parts;
}
