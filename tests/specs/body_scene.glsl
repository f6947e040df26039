#ifdef VERTEX
layout(location = 0) out vec3 world_normal;
layout(location = 1) out vec2 uv;
layout(location = 2) flat out uint material;
layout(location = 3) flat out uint triangle;
void main()
{
    gl_Position = view.view_projection * vec4(vertex_position, 1.0);
    world_normal = vertex_normal;
    uv = vertex_uv;
    material = vertex_material;
    triangle = vertex_triangle;
}
#endif
#ifdef FRAGMENT
layout(location = 0) in vec3 world_normal;
layout(location = 1) in vec2 uv;
layout(location = 2) flat in uint material;
layout(location = 3) flat in uint triangle;
void main()
{
    SceneMaterial m = scene_materials[material];
    vec4 texel = scene_texture(uv, m.texture_layer);
    if (texel.a < m.alpha_cutoff)
        discard;
    color = vec4(m.albedo * texel.rgb + m.emission, gl_FrontFacing ? world_normal.x : gl_FragCoord.x) * float(triangle + 1u);
}
#endif
