#version 450
layout(local_size_x = 3) in;
layout(binding = 0, std430) readonly buffer Indices { uint indices[]; };
layout(binding = 1, std430) writeonly buffer Kept { uint kept[6]; };

/* the third and the fifth triangle of the scene */
void main()
{
    kept[gl_LocalInvocationIndex] = indices[6 + gl_LocalInvocationIndex];
    kept[3 + gl_LocalInvocationIndex] = indices[12 + gl_LocalInvocationIndex];
}
