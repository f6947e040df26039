#version 450
layout(location = 0) in vec3 position;
layout(location = 2) in vec2 uv;
layout(location = 3) in uint material;
layout(location = 0) out vec2 v_uv;
layout(location = 1) flat out uint v_material;

void main()
{
    gl_Position = vec4(position, 1);
    v_uv = uv;
    v_material = material;
}
