#version 450
#extension GL_ARB_shader_viewport_layer_array : require
#ifdef VULKAN
#define INSTANCE gl_InstanceIndex
#else
#extension GL_ARB_shader_draw_parameters : require
#define INSTANCE (gl_BaseInstanceARB + gl_InstanceID)
#endif
layout(location = 0) in vec3 position;
layout(location = 0) flat out uint v_layer;

void main()
{
    gl_Position = vec4(position, 1);
    gl_Layer = INSTANCE;
    v_layer = INSTANCE;
}
