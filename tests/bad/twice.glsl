#include "twice_part.glsl"
#include "twice_part.glsl"
void main()
{
    a_store(invocation().xy, vec4(doubled(0.25)));
}
