#version 450
layout(local_size_x = 8, local_size_y = 4) in;
layout(constant_id = 3) const int step_size = 3;
layout(set = 1, binding = 3, rgba32f) uniform writeonly image2D target;
layout(set = 0, binding = 9, std430) buffer Sums { uint sums[]; };
layout(push_constant) uniform Push { vec2 slope; bool bright; float weights[3]; } push;
uniform float loose; /* OpenGL's */
void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(p, imageSize(target))))
        return;
    imageStore(target, p, vec4(vec2(p) * push.slope, push.weights[2] + loose, push.bright ? 2.0 : 0.0));
    atomicAdd(sums[p.x & 3], uint(step_size));
}
