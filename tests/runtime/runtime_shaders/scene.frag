#version 450
struct Material { vec3 albedo; int tex; vec3 emission; float alpha_cutoff; };
layout(binding = 0, std430) readonly buffer Materials { Material materials[]; };
layout(binding = 1) uniform sampler2DArray textures;
layout(location = 0) in vec2 v_uv;
layout(location = 1) flat in uint v_material;
layout(location = 0) out vec4 color;

void main()
{
    Material m = materials[v_material];
    vec3 texel = m.tex < 0 ? vec3(1) : texture(textures, vec3(v_uv, m.tex)).rgb;
    color = vec4(m.albedo * texel, 1);
}
