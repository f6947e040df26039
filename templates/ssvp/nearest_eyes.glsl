/* The eye whose map a VPL uses, `nearest`: the nearest by the metric of all that are kept. Where only
 * this frame's maps are kept, it is the eye of the VPL's cluster. -1: no flux. */
int nearest_eye(vec3 x, vec3 n)
{
    float least = 1e30;
    int found = 0;
    for (int e = 0; e < eyes_count; e++) {
        if (eyes[e].used == 0)
            continue;
        float d = vpl_distance(x, n, eyes[e].position, eyes[e].normal);
        found = d < least ? e : found;
        least = min(d, least);
    }
    return found;
}

void main()
{
    int k = invocation().x;
    if (k >= points_count)
        return;
    int label = labels[k];
    nearest[k] = label >= 0 && eyes_move == 1 ? nearest_eye(points[k].position, points[k].normal) : label;
}
