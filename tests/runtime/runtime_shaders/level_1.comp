#version 450
layout(local_size_x = 8, local_size_y = 4) in;
layout(binding = 0) uniform sampler2D level_0;
layout(binding = 1, r32f) writeonly uniform image2D level_1;

/* between four texels: their mean, if the sampler is linear */
void main()
{
    vec2 uv = (vec2(gl_GlobalInvocationID.xy) + 0.5) / vec2(8, 4);
    imageStore(level_1, ivec2(gl_GlobalInvocationID.xy), vec4(textureLod(level_0, uv, 0).r));
}
