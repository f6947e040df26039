#ifdef VERTEX
layout(location = 0) flat out uint material;

void main()
{
    material = vertex_material;
    gl_Position = view.view_projection * vec4(vertex_position, 1.0);
}
#endif

#ifdef FRAGMENT
layout(location = 0) flat in uint material;

void main()
{
    number = uvec4(material + 1u, 0u, 0u, 1u);
    tint = vec4(gl_FragCoord.xy * 0.013, float(material) * 0.11, 1.0);
}
#endif
