#define scale bars
#define weights tint
#include "groups_paint.glsl"
