// One file twice, behind a guard, and with other macros in between.
// expect: 5 2 1
#include "include/guarded.glsl"
#define GUARDED_AGAIN
#include "include/guarded.glsl"
#include "include/guarded.glsl" // for certain
void main()
{
    result[0] = guarded(two);
    result[1] = GUARDED_VALUE * one;
#ifdef GUARDED_AGAIN
    result[2] = one;
#else
    result[2] = two;
#endif
}
