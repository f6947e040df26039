#ifndef RIGHT_GLSL
#define RIGHT_GLSL
#include "left.glsl"
float right_value(float x)
{
    return left_value(x) + two;
}
#endif
