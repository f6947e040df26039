/* VPLs in the order in which interleave classes shade them. Classes with one VPL less get a VPL of
 * zero flux. */
#include "../ssvp/classes.glsl"

void main()
{
    int slot = invocation().x;
    if (slot >= lights_count)
        return;
    int wanted = class_member(slot / class_first, slot % class_first);
    int k = min(wanted, first_vpls - 1);
    lights[slot].position = vpls[k].position;
    lights[slot].disk = softness * vpls[k].area / PI;
    lights[slot].normal = vpls[k].normal;
    lights[slot].cluster = max(labels[k], 0);
    lights[slot].flux = wanted < first_vpls ? vpls[k].flux : vec3(0.0);
}
