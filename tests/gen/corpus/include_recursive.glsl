// A file that includes itself until a macro says that it is enough.
// expect: 4 1111
#define DEPTH_0
#include "include/recursive.glsl"
void main()
{
    result[0] = float(depth) * one;
    result[1] = digits * one;
}
