/* Denoising, along columns. */
#define SOURCE irradiance_rows
#include "denoise_axis.glsl"

void main()
{
    ivec2 size = irradiance_rows_size();
    ivec2 p = invocation().xy;
    if (p.x >= size.x || p.y >= size.y)
        return;
    indirect_store(p, filter_axis(p, irradiance_rows(p).rgb, size, ivec2(0, 1), tile.y));
}
