/* One bin of a histogram of red per invocation, counted serially: no atomics, one order. */
void main()
{
    int bin = invocation().x;
    if (bin >= bins)
        return;
    ivec2 size = color_size();
    uint n = 0u;
    vec3 sum = vec3(0.0);
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) {
            vec3 c = color(ivec2(x, y)).rgb;
            if (min(int(c.r * float(bins)), bins - 1) == bin && label(ivec2(x, y)).x != 7u) {
                n += 1u;
                sum += c;
            }
        }
    histogram[bin].count = n;
    histogram[bin].mean = n > 0u ? sum / float(n) : vec3(0.0);
    histogram[bin].square = points(bin);
    histogram[bin].polar = disk(bin);
    histogram[bin].concentric = disk2(bin);
    float d = near(vec3(points(bin), 0.0), vec3(0.0, 0.0, 1.0), vec3(0.25, 0.5, 0.75), vec3(0.0, 0.6, 0.8));
    histogram[bin].apart = d;
    pattern[bin] = vec4(points(bin).y, disk2(bin), d);
    if (bin == 0) {
        arguments[0].x = uint((bins + 7) / 8);
        arguments[0].y = 1u;
        arguments[0].z = 1u;
    }
}
