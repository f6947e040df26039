/* Tone mapping, second level of the log-average: one workgroup sums the tiles. Each invocation sums
 * a strided run, then a tree follows, both in fixed order. Writes the factor on radiance before the
 * curve: exposure / log-average. */
shared float log_sum[256];
shared float surface_sum[256];

void main()
{
    int lane = int(gl_LocalInvocationIndex);
    float logs = 0.0;
    float surfaces = 0.0;
    for (int k = lane; k < luminance_tiles_count; k += 256) {
        logs += luminance_tiles[k].x;
        surfaces += luminance_tiles[k].y;
    }
    log_sum[lane] = logs;
    surface_sum[lane] = surfaces;
    barrier();
    for (int stride = 128; stride > 0; stride /= 2) {
        if (lane < stride) {
            log_sum[lane] += log_sum[lane + stride];
            surface_sum[lane] += surface_sum[lane + stride];
        }
        barrier();
    }
    if (lane == 0)
        luminance_scale[0] = exposure / exp(log_sum[0] / max(surface_sum[0], 1.0));
}
