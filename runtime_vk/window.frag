#version 460
/* A texture of the window times the vertex's colour. See present.c. */
layout(binding = 1) uniform sampler2D picture;
layout(location = 0) in vec2 uv;
layout(location = 1) in vec4 color;
layout(location = 0) out vec4 shown;

void main()
{
    shown = color * texture(picture, uv);
}
