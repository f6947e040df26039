// Distances to a box and to a circle.
// expect: 2.0615528 0.91421354 -0.5
float box(vec2 p, vec2 b)
{
    vec2 d = abs(p) - b;
    return length(max(d, 0.0)) + min(max(d.x, d.y), 0.0);
}
float circle(vec2 p, float r) { return length(p) - r; }
void main()
{
    result[0] = box(vec2(three, two + half_), vec2(one, two));
    result[1] = circle(vec2(one), half_);
    result[2] = box(vec2(0.0), vec2(half_, three) * one);
}
