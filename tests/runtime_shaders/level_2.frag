#version 460
#ifdef VULKAN /* has a view of one mip */
#define LEVEL 0
#else
#define LEVEL 1
#endif
layout(binding = 0) uniform sampler2D level_1;
layout(location = 0) out float level_2;

void main()
{
    level_2 = 2 * texelFetch(level_1, 2 * ivec2(gl_FragCoord.xy), LEVEL).r;
}
