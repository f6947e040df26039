#ifdef VERTEX
layout(location = 0) out vec4 color;

void main()
{
    const ivec2 corners[6] = ivec2[](ivec2(0), ivec2(1, 0), ivec2(0, 1), ivec2(0, 1), ivec2(1, 0), ivec2(1));
    Particle particle = particles[gl_InstanceIndex];
    vec2 texel = vec2(particle.place + corners[gl_VertexIndex] * particle.size);
    color = particle.color;
    gl_Position = vec4(2.0 * texel / vec2(frame.width, frame.height) - 1.0, 0.0, 1.0);
}
#else
layout(location = 0) in vec4 color;

void main()
{
    over = premultiplied = added = least = largest = multiplied = color;
}
#endif
