#version 450
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0, std140) uniform Live { uint enabled; float scale; };
layout(binding = 1, r32f) writeonly uniform image2D mask;

void main()
{
    imageStore(mask, ivec2(gl_GlobalInvocationID.xy), vec4(scale * gl_GlobalInvocationID.x));
}
