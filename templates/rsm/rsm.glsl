/* Reflective shadow map with the flux of every texel. */
#define RSM_FLUX
#include "../shared/rsm.glsl"
