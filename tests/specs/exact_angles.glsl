void main()
{
    int i = invocation().x;
    if (i >= cases)
        return;
    angles[i].arc_sine = asin(inputs[i].s);
    angles[i].arc_cosine = acos(inputs[i].s);
    angles[i].arc_tangent = atan(inputs[i].a);
    angles[i].arc_tangent2 = atan(inputs[i].a, inputs[i].b);
}
