/* What the light's view can see. */
#define VIEW light_view
#include "frustum.glsl"
