/* Directions over the plane z = 0, as dense as their cosine, and lengths up to 1. Multiples of the
 * golden ratio spread the lengths, whatever the number of samples. Each frame shifts both. */
#include "../shared/reuse.glsl"

void main()
{
    int k = invocation().x;
    if (k >= samples)
        return;
    vec2 p = shift_disk(disk_points(k));
    taps[k].direction = vec3(p, sqrt(max(1.0 - dot(p, p), 0.0)));
    taps[k].reach = fract((float(k) + 0.5) * 0.61803399 + pattern_shift().x);
}
