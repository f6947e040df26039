/* The sampling pattern around a pixel's projection (Dachsbacher, Stamminger 2005, section 4.1):
 * offsets r (sin, cos) with r uniform, so denser near the middle; weights r^2 compensate, here with
 * the sum 1. polar_disk has the radius sqrt(u), so p |p| has the radius u; over u = k / n the sum
 * of u^2 is (n - 1) (2 n - 1) / (6 n). Each frame turns the pattern. */
#include "../shared/reuse.glsl"

void main()
{
    int k = invocation().x;
    if (k >= samples)
        return;
    vec2 p = turn_disk(disk_points(k));
    float r = dot(p, p);
    float n = float(samples);
    taps[k].offset = p * length(p);
    taps[k].weight = r * r * 6.0 * n / ((n - 1.0) * (2.0 * n - 1.0));
}
