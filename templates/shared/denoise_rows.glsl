/* Denoising, along rows. */
#define SOURCE irradiance
#include "denoise_axis.glsl"

void main()
{
    ivec2 size = irradiance_size();
    ivec2 p = invocation().xy;
    if (p.x >= size.x || p.y >= size.y)
        return;
    settled_store(p, irradiance(p));
    settled_depth_store(p, vec4(gbuffer_position(p).w));
    irradiance_rows_store(p, filter_axis(p, size, ivec2(1, 0), tile.x));
}
