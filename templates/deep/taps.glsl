/* Directions of a spiral: multiples of the golden angle. Each frame turns it. */
#include "../shared/reuse.glsl"

void main()
{
    int k = invocation().x;
    if (k >= samples)
        return;
    float angle = 2.39996323 * float(k);
    taps[k].direction = turn_disk(vec2(cos(angle), sin(angle)));
}
