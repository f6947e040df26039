#version 460
/* A vertex of what the window shows: fetched from a storage buffer, in clip space already. See present.c. */
struct Vertex { float x, y, u, v; uint color; };
layout(std430, binding = 0) readonly buffer Vertices { Vertex vertices[]; };
layout(location = 0) out vec2 uv;
layout(location = 1) out vec4 color;

void main()
{
    Vertex v = vertices[gl_VertexIndex];
    uv = vec2(v.u, v.v);
    color = unpackUnorm4x8(v.color);
    gl_Position = vec4(v.x, v.y, 0.0, 1.0);
}
