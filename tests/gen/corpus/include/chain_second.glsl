#include "chain_third.glsl" // comment
#define STEP 11.0
float chain_second(float x)
{
    return chain_third(x) - STEP;
}
