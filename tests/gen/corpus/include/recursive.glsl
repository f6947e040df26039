#if defined(DEPTH_3)
const int depth = 4;
const float digits = 1000.0 + DIGITS_2 + DIGITS_1 + DIGITS_0;
#elif defined(DEPTH_2)
#define DIGITS_2 100.0
#define DEPTH_3
#include "recursive.glsl"
#elif defined(DEPTH_1)
#define DIGITS_1 10.0
#define DEPTH_2
#include "recursive.glsl"
#elif defined(DEPTH_0)
#define DIGITS_0 1.0
#define DEPTH_1
#include "recursive.glsl"
#endif
