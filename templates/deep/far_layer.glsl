/* Triangles of the second layer of the G-buffer. */
#define PEEL
#include "../shared/visible.glsl"
