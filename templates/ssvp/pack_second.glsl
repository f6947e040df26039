/* Second-bounce VPLs in the order in which interleave classes shade them; see pack_first.glsl. */
#include "classes.glsl"

void main()
{
    int slot = invocation().x;
    if (slot >= class_count * class_second)
        return;
    int wanted = class_member(slot / class_second, slot % class_second);
    int k = min(wanted, second_total - 1);
    shading_second[slot].position = second_vpl[k].position;
    int c = max(second_labels[k], 0);
    shading_second[slot].layer = c;
    shading_second[slot].normal = second_vpl[k].normal;
    shading_second[slot].disk = softness * second_vpl[k].area / PI;
    shading_second[slot].flux = wanted < second_total ? second_vpl[k].flux : vec3(0.0);
    shading_second[slot].eye = second_views[c].position;
    shading_second[slot].tangent = second_views[c].tangent;
    shading_second[slot].bitangent = second_views[c].bitangent;
    shading_second[slot].axis = second_views[c].normal;
}
