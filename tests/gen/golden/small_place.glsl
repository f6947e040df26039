void main()
{
    int i = invocation().x;
    if (i >= lamp_count)
        return;
    lamps[i].position = vec3(float(i % grid.x), float(i / grid.x % grid.y), 1.0);
    lamps[i].power = 1.0 / float(i + 1);
    lamps[i].color = vec3(1.0, 0.5, 0.25);
}
