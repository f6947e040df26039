#version 460
layout(local_size_x = 1) in;
layout(binding = 0, std140) uniform Frame { vec4 skip[41]; uint width, height, index, triangle_count; };
layout(binding = 1, std430) writeonly buffer Draws { uint draw[5]; };
layout(binding = 2, std430) writeonly buffer Groups { uint groups[3]; };

void main()
{
    draw[0] = 3 * triangle_count;
    draw[1] = 4; /* instances, one per layer */
    draw[2] = 0;
    draw[3] = 0;
    draw[4] = 0;
    groups[0] = (width + 7) / 8;
    groups[1] = (height + 7) / 8;
    groups[2] = 1;
}
