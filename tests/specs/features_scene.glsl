#ifdef VERTEX
layout(location = 0) out vec3 world_normal;
layout(location = 1) out vec2 uv;
layout(location = 2) flat out uint material;
void main()
{
    gl_Position = view.view_projection * vec4(vertex_position, 1.0);
    world_normal = vertex_normal;
    uv = vertex_uv;
    material = vertex_material;
}
#endif
#ifdef FRAGMENT
layout(location = 0) in vec3 world_normal;
layout(location = 1) in vec2 uv;
layout(location = 2) flat in uint material;
void main()
{
    SceneMaterial m = scene_materials[material];
    vec4 texel = m.texture_layer >= 0 ? scene_texture(uv, m.texture_layer) : vec4(1.0);
    if (texel.a < m.alpha_cutoff)
        discard;
    color = vec4(m.albedo * texel.rgb, 1.0);
    normal = vec4(normalize(world_normal), 1.0);
    label = uvec4(material + 1u);
}
#endif
