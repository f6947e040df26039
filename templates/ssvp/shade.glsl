/* Shading in place: each class reads and writes its own pixels, strided. */
#include "vpl.glsl"

void main()
{
    ivec2 p = interleave_pixel();
    vec3 x = gbuffer_position(p).xyz;
    vec3 n = gbuffer_normal(p).xyz;
#include "shade_vpls.glsl"
    irradiance_store(p, shaded);
}
