/* One list: triangles with keeps_triangle(a, b, c). */
#include "test.glsl"

void main()
{
    vec3 a, b, c;
    bool real = triangle_of(a, b, c);
    store_lists(uvec4(real && keeps_triangle(a, b, c) ? 1u : 0u, 0u, 0u, 0u));
}
