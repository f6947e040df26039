/* First-bounce VPLs in the order in which interleave classes shade them, each with the view of its
 * cluster's map, since a VPL takes the map of its cluster as its own. Classes that get one less are
 * filled up with VPLs of zero flux. */
#include "classes.glsl"

void main()
{
    int slot = invocation().x;
    if (slot >= class_count * class_first)
        return;
    int wanted = class_member(slot / class_first, slot % class_first);
    int k = min(wanted, first_vpls - 1);
    int c = max(labels[k], 0);
    shading_first[slot].position = vpls[k].position;
    shading_first[slot].layer = c;
    shading_first[slot].normal = vpls[k].normal;
    shading_first[slot].disk = softness * vpls[k].area / PI;
    shading_first[slot].flux = wanted < first_vpls ? vpls[k].flux : vec3(0.0);
    shading_first[slot].eye = cluster_views[c].position;
    shading_first[slot].tangent = cluster_views[c].tangent;
    shading_first[slot].bitangent = cluster_views[c].bitangent;
    shading_first[slot].axis = cluster_views[c].normal;
}
