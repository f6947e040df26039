#version 450
layout(location = 0) out vec4 glow;

void main()
{
    glow = vec4(0.5, 0, 1, 0.5);
}
