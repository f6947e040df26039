// A file as statements of a function, and as the elements of a list.
// expect: 6 4
const float weights[] = float[](
#include "include/list.glsl"
);
void main()
{
    float sum = 0.0;
#include "include/statements.glsl"
    result[0] = sum;
    result[1] = weights[weights.length() - 1] * one + one;
}
