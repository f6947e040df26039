#version 450
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0) uniform sampler2D depth;
layout(binding = 1, r32f) writeonly uniform image2D level;

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    imageStore(level, p, vec4(texelFetch(depth, p % textureSize(depth, 0), 0).r));
}
