#ifndef GUARDED_GLSL
#define GUARDED_GLSL
#define GUARDED_VALUE 2.0
float guarded(float x)
{
    return x + three;
}
#endif
