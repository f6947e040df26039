/* A list for each element: triangles with keeps_triangle(a, b, c, element). */
#include "test.glsl"

void main()
{
    vec3 a, b, c;
    bool real = triangle_of(a, b, c);
    uvec2 mask = uvec2(0u);
    int list = 0;
    for (auto element : elements) {
        uint bit = real && keeps_triangle(a, b, c, element) ? 1u : 0u;
        mask |= list < 32 ? uvec2(bit << list, 0u) : uvec2(0u, bit << (list - 32));
        list++;
    }
    store_lists(mask);
}
