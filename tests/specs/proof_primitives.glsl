#ifdef VERTEX
layout(location = 0) flat out int number;

void main()
{
    vec2 corner = vec2(gl_VertexIndex % 3 >> 1, gl_VertexIndex % 3 & 1) * 0.25;
    number = gl_BaseVertex + gl_BaseInstance + gl_DrawID;
    gl_Position = vec4(corner + vec2(gl_InstanceIndex & 7, gl_InstanceIndex >> 3) * 0.25 - 1.0, 0.5, 1.0);
}
#endif

#ifdef FRAGMENT
layout(location = 0) flat in int number;

void main()
{
    primitive = uvec4(gl_PrimitiveID + number);
}
#endif
