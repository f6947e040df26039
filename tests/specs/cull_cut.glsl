/* Three slabs of the scene's height; the last one is higher than the scene. */
void main()
{
    int k = invocation().x;
    if (k >= 3)
        return;
    slabs[k].low = frame.scene_center.y + frame.scene_radius * (k == 2 ? 3.0 : 0.25 * float(k) - 0.25);
    slabs[k].high = slabs[k].low + 0.25 * frame.scene_radius;
}
