#version 450
#ifdef VULKAN
#define VERTEX gl_VertexIndex
#else
#define VERTEX gl_VertexID
#endif

void main()
{
    gl_Position = vec4(VERTEX == 1 ? 3 : -1, VERTEX == 2 ? 3 : -1, 0, 1);
}
