/* Denoising, along rows, of light without outliers. */
#define SOURCE irradiance
#include "denoise_axis.glsl"

float sum_of_channels(vec3 light)
{
    return light.r + light.g + light.b;
}

/* The light of p, at most denoise_outlier times as bright as the brightest pixel of its class around it,
 * which is one tile away. Where few pixels show a surface, one that meets a VPL of its class would stay
 * far too bright after the filter. Pixels of other classes say nothing: what all pixels of one class meet
 * is as bright there as it should be, and dark surroundings set no limit. */
vec3 without_outlier(ivec2 p, vec3 light)
{
    ivec2 last = irradiance_size() - 1;
    float brightest = 0.0;
    for (int k = 0; k < 9; k++) {
        ivec2 beside = clamp(p + (ivec2(k % 3, k / 3) - 1) * tile, ivec2(0), last);
        float sum = sum_of_channels(irradiance(beside).rgb);
        brightest = k == 4 ? brightest : approximate_max(brightest, sum);
    }
    float limit = denoise_outlier * brightest;
    float own = sum_of_channels(light);
    return limit > 0.0 && own > limit ? light * (limit * reciprocal_close(own)) : light;
}

void main()
{
    ivec2 size = irradiance_size();
    ivec2 p = invocation().xy;
    if (p.x >= size.x || p.y >= size.y)
        return;
    vec4 light = irradiance(p);
    settled_store(p, light);
    settled_depth_store(p, vec4(gbuffer_position(p).w));
    irradiance_rows_store(p, filter_axis(p, without_outlier(p, light.rgb), size, ivec2(1, 0), tile.x));
}
