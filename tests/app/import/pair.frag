#version 450
layout(location = 0) in vec2 uv;
layout(location = 0) out vec4 color;
layout(set = 2, binding = 5) uniform texture2D photo;
layout(set = 2, binding = 6) uniform sampler nearest;
void main()
{
    color = vec4(texture(sampler2D(photo, nearest), uv).rgb, uv.y);
}
