/* Denoising, along rows. */
#define SOURCE irradiance
#include "denoise_axis.glsl"

void main()
{
    ivec2 size = irradiance_size();
    ivec2 p = invocation().xy;
    if (p.x >= size.x || p.y >= size.y)
        return;
    irradiance_rows_store(p, filter_axis(p, size, ivec2(1, 0), tile.x));
}
