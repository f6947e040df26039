/* Shading in split order: each class reads and writes a block of its own. */
#include "vpl.glsl"

void main()
{
    ivec2 q = interleave_split();
    vec3 x = split_position(q).xyz;
    vec3 n = split_normal(q).xyz;
#include "shade_vpls.glsl"
    split_irradiance_store(q, shaded);
}
