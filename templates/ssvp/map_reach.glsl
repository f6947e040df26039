/* Reach of the surfaces in a map, `reach`, of the numbers of the triangles. */
#include "measured.glsl"

void main()
{
    ivec3 at = invocation();
    if (any(greaterThanEqual(at.xy, reach_size())))
        return;
    reach_store(at, vec4(measured_reach(at, number(at).x)));
}
