#ifndef LEFT_GLSL
#define LEFT_GLSL
float left_value(float x);
#include "right.glsl"
float left_value(float x)
{
    return x + one;
}
#endif
