/* Second layer of the G-buffer. */
#define PEEL
#define gbuffer_position far_position
#define gbuffer_normal far_normal
#define gbuffer_albedo far_albedo
#include "../shared/gbuffer.glsl"
