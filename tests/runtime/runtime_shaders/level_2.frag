#version 450
layout(binding = 0) uniform sampler2D level_1; /* a view of one mip */
layout(location = 0) out float level_2;

void main()
{
    level_2 = 2 * texelFetch(level_1, 2 * ivec2(gl_FragCoord.xy), 0).r;
}
