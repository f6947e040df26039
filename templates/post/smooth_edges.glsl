/* Smooth edges by luma. A pixel beside an edge lies on one side of it; between the ends of its run
 * the edge moves by one pixel, so the pixel takes a share of the other side: most at an end of the
 * run, none in its middle. Luma is of sRGB codes, as the eye sees contrast. */
float luma(ivec2 p)
{
    return dot(graded(clamp(p, ivec2(0), graded_size() - 1)).rgb, vec3(0.299, 0.587, 0.114));
}

/* Pixels to the end of the run, at most edge_steps, in the direction `along`. The run ends where
 * the mean of both sides differs from `middle` by at least `limit`; `change` is that difference. */
int run_end(ivec2 p, ivec2 side, ivec2 along, float middle, float limit, out float change)
{
    int i = 0;
    do {
        i++;
        change = 0.5 * (luma(p + along * i) + luma(p + side + along * i)) - middle;
    } while (i < edge_steps && abs(change) < limit);
    return i;
}

void main()
{
    ivec2 size = graded_size();
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, size)))
        return;
    const ivec2 right = ivec2(1, 0), up = ivec2(0, 1);
    float m = luma(p), n = luma(p + up), s = luma(p - up), e = luma(p + right), w = luma(p - right);
    float most = max(max(max(n, s), max(e, w)), m);
    float contrast = most - min(min(min(n, s), min(e, w)), m);
    if (contrast < max(edge_dark, edge * most)) {
        display_store(p, graded(p));
        return;
    }
    float ne = luma(p + up + right), nw = luma(p + up - right);
    float se = luma(p - up + right), sw = luma(p - up - right);

    float rows = 2.0 * abs(n + s - 2.0 * m) + abs(ne + se - 2.0 * e) + abs(nw + sw - 2.0 * w);
    float columns = 2.0 * abs(e + w - 2.0 * m) + abs(ne + nw - 2.0 * n) + abs(se + sw - 2.0 * s);
    bool level = rows >= columns; /* the edge runs along x */
    ivec2 along = level ? right : up;
    ivec2 across = level ? up : right;
    float after = level ? n : e, before = level ? s : w;
    bool is_after = abs(after - m) >= abs(before - m);
    ivec2 side = is_after ? across : -across;
    float other = is_after ? after : before;
    float middle = 0.5 * (m + other), limit = 0.25 * abs(other - m);

    float change_first, change_last;
    int first = run_end(p, side, -along, middle, limit, change_first);
    int last = run_end(p, side, along, middle, limit, change_last);
    float change = first < last ? change_first : change_last;
    bool crosses = (change < 0.0) != (m < middle); /* the other side continues beyond that end */
    float share = crosses ? 0.5 - float(min(first, last)) / float(first + last) : 0.0;

    /* Single pixels and thin lines differ from the mean of their neighbours. */
    float mean = (2.0 * (n + s + e + w) + ne + nw + se + sw) * (1.0 / 12.0);
    float alone = smoothstep(0.0, 1.0, clamp(abs(mean - m) / contrast, 0.0, 1.0));
    share = max(share, alone * alone * subpixel);
    display_store(p, graded_sample((vec2(p) + 0.5 + vec2(side) * share) / vec2(size)));
}
