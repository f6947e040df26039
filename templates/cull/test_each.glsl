/* Lists for each element: keeps_triangle(a, b, c, element) has a bit for each. */
#include "test.glsl"

void main()
{
    vec3 a, b, c;
    bool real = triangle_of(a, b, c);
    uvec4 mask = uvec4(0u);
    int list = 0;
    for (auto element : elements) {
        uint kept = real ? uint(keeps_triangle(a, b, c, element)) << (list & 31) : 0u;
        mask |= uvec4(list < 32 ? kept : 0u, list >= 32 && list < 64 ? kept : 0u,
                      list >= 64 && list < 96 ? kept : 0u, list >= 96 ? kept : 0u);
        list += parts;
    }
    store_lists(mask);
}
