/* Maps that are kept: each frame's take the place of the oldest. The layer of a map of this frame, which
 * draws `per_frame` of them. `rounds`: frames whose maps are kept. */
int kept_layer(int map, int per_frame, int rounds)
{
    return int(frame.index % uint(rounds)) * per_frame + map;
}
