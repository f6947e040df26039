#define scale gain
#define weights tint
#include "groups_paint.glsl"
