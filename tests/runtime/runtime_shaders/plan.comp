#version 450
layout(local_size_x = 1) in;
layout(binding = 0, std140) uniform Frame { vec4 skip[41]; uint width, height, index, triangle_count; };
layout(binding = 1, std430) writeonly buffer Draws { uint draw[10]; };
layout(binding = 2, std430) writeonly buffer Groups { uint groups[3]; };

void main()
{
    for (uint i = 0; i < 2; i++) { /* the first triangle in layer 2, the second in layer 1 */
        draw[5 * i] = 3;
        draw[5 * i + 1] = 1;
        draw[5 * i + 2] = 3 * i;
        draw[5 * i + 3] = 0;
        draw[5 * i + 4] = 2 - i;
    }
    groups[0] = (width + 7) / 8;
    groups[1] = (height + 7) / 8;
    groups[2] = 1;
}
