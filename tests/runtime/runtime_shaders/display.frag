#version 450
layout(binding = 0) uniform sampler2D color;
layout(location = 0) out vec4 display;

void main()
{
    display = texelFetch(color, ivec2(gl_FragCoord.xy), 0);
}
