#version 450
layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba8, set = 2, binding = 7) uniform writeonly image2D target;
layout(push_constant) uniform Push { vec4 tint; float scale; } push;
#ifdef TEXTURE
layout(binding = 3) uniform sampler2D photo[2];
#endif
void main()
{
#ifdef TEXTURE
    imageStore(target, ivec2(0), texture(photo[1], vec2(0.5)));
#else
    imageStore(target, ivec2(gl_GlobalInvocationID.xy), push.tint * push.scale);
#endif
}
