/* First-bounce VPLs in the order in which interleave classes shade them, and the eyes that these ask:
 * those of all clusters, since a VPL takes the map of its cluster as its own; where a class has fewer
 * VPLs than there are clusters, one for each VPL. Classes that get one less are filled up with VPLs of
 * zero flux. */
#include "classes.glsl"
#include "eyes.glsl"

void main()
{
    int slot = invocation().x;
    if (slot >= class_count * class_first)
        return;
    int j = slot % class_first;
    int wanted = class_member(slot / class_first, j);
    int k = min(wanted, first_vpls - 1);
    int c = max(labels[k], 0);
    bool all_clusters = first_eyes == clusters;
    shading_first[slot].position = vpls[k].position;
    shading_first[slot].disk = softness * vpls[k].area / PI;
    shading_first[slot].normal = vpls[k].normal;
    shading_first[slot].flux = wanted < first_vpls ? vpls[k].flux : vec3(0.0);
    shading_first[slot].eye = eye_bit(all_clusters ? c : j);
    if (j >= first_eyes)
        return;
    int place = slot / class_first * first_eyes + j;
    c = all_clusters ? j : c;
    shading_first_eyes[place].position = cluster_views[c].position;
    shading_first_eyes[place].layer = c;
    shading_first_eyes[place].tangent = cluster_views[c].tangent;
    shading_first_eyes[place].bitangent = cluster_views[c].bitangent;
    shading_first_eyes[place].axis = cluster_views[c].normal;
    shading_first_eyes[place].bit = eye_bit(j);
}
