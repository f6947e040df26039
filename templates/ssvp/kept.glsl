/* Maps that are kept: each frame's take the place of the oldest. The layer, of `all`, of a map of this
 * frame, which draws `per_frame` of them. */
int kept_layer(int map, int per_frame, int all)
{
    return int(frame.index % uint(all / per_frame)) * per_frame + map;
}
