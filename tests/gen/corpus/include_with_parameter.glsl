// A file as a template: macros stand for a type and a name.
// expect: 8 27 18
#define CUBE_TYPE float
#define CUBE_NAME cube
#include "include/template.glsl"
#undef CUBE_TYPE
#undef CUBE_NAME
#define CUBE_TYPE ivec2
#define CUBE_NAME cube_pair
#include "include/template.glsl"
void main()
{
    result[0] = cube(two);
    ivec2 p = cube_pair(ivec2(int(three), int(one) + 1));
    result[1] = float(p.x);
    result[2] = float(p.y) + 10.0 * one;
}
