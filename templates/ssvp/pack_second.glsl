/* Second-bounce VPLs in the order in which interleave classes shade them, and the eyes that these ask;
 * see pack_first.glsl. */
#include "classes.glsl"
#include "eyes.glsl"

void main()
{
    int slot = invocation().x;
    if (slot >= class_count * class_second)
        return;
    int j = slot % class_second;
    int wanted = class_member(slot / class_second, j);
    int k = min(wanted, second_total - 1);
    int c = max(second_labels[k], 0);
    bool all_clusters = second_eyes == second_maps;
    shading_second[slot].position = second_vpl[k].position;
    shading_second[slot].disk = softness * second_vpl[k].area / PI;
    shading_second[slot].normal = second_vpl[k].normal;
    shading_second[slot].flux = wanted < second_total ? second_vpl[k].flux : vec3(0.0);
    shading_second[slot].eye = eye_bit(all_clusters ? c : j);
    if (j >= second_eyes)
        return;
    int place = slot / class_second * second_eyes + j;
    c = all_clusters ? j : c;
    shading_second_eyes[place].position = second_views[c].position;
    shading_second_eyes[place].layer = c;
    shading_second_eyes[place].tangent = second_views[c].tangent;
    shading_second_eyes[place].bitangent = second_views[c].bitangent;
    shading_second_eyes[place].axis = second_views[c].normal;
    shading_second_eyes[place].bit = eye_bit(j);
}
