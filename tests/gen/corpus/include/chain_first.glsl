// Beside its file, though that is included from another folder.
#include "chain_second.glsl"
float chain_first(float x)
{
    return x * STEP;
}
