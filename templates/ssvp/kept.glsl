/* Maps that are kept: each frame's take the place of the oldest. The layer of a map of this frame among
 * `kept`, of `maps` that a frame draws. */
int kept_layer(int map, int maps, int kept)
{
    return int(frame.index % uint(kept / maps)) * maps + map;
}
