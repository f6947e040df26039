#version 450
#ifdef VERTEX
layout(location = 0) in vec2 place;
layout(location = 0) out vec2 uv;
void main()
{
    gl_Position = vec4(2.0 * place - 1.0, 0.0, 1.0);
    uv = place;
}
#else
layout(location = 0) in vec2 uv;
layout(location = 0) out vec4 color;
layout(set = 3, binding = 9) uniform sampler2D glow;
layout(set = 3, binding = 2) uniform sampler2D before;
void main() { color = mix(textureLod(glow, uv, 1.5), texture(before, uv), 0.5); }
#endif
