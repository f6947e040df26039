/* Tone mapping, first level of the log-average (Reinhard et al. 2002, Equation 1): one workgroup of
 * 8x8 invocations sums 32x32 pixels. Each invocation sums sixteen pixels, then a tree follows, both
 * in fixed order, so the sum has the same bits on every run. x: sum of log(delta + L); y: number of
 * pixels that show a surface. Background pixels do not count: the amount of sky must not change the
 * exposure of a room. */
shared float log_sum[64];
shared float surface_sum[64];

void main()
{
    int lane = int(gl_LocalInvocationIndex);
    ivec2 size = radiance_size();
    ivec2 first = ivec2(gl_WorkGroupID.xy) * 32 + ivec2(gl_LocalInvocationID.xy);
    float logs = 0.0;
    float surfaces = 0.0;
    for (int i = 0; i < 16; i++) {
        ivec2 p = first + 8 * ivec2(i % 4, i / 4);
        vec4 colour = radiance(min(p, size - 1));
        bool counts = p.x < size.x && p.y < size.y && colour.a > 0.0;
        float luminance = dot(colour.rgb, vec3(0.2126, 0.7152, 0.0722));
        logs += counts ? log(luminance_delta + luminance) : 0.0;
        surfaces += counts ? 1.0 : 0.0;
    }
    log_sum[lane] = logs;
    surface_sum[lane] = surfaces;
    barrier();
    for (int stride = 32; stride > 0; stride /= 2) {
        if (lane < stride) {
            log_sum[lane] += log_sum[lane + stride];
            surface_sum[lane] += surface_sum[lane + stride];
        }
        barrier();
    }
    int tile_index = int(gl_WorkGroupID.x) + tiles_x * int(gl_WorkGroupID.y);
    if (lane == 0)
        luminance_tiles[tile_index] = vec2(log_sum[0], surface_sum[0]);
}
