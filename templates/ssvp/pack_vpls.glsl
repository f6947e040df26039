/* Packs VPLs and the eyes that they use, in the order in which interleave classes shade them. Classes
 * with one VPL less get a VPL of zero flux. */
#include "classes.glsl"

/* Factor on the flux of second-bounce VPLs, so that they carry the light of all further bounces,
 * too, if each bounce reflects the same share q: 1 + q + q^2 + ... = 1 / (1 - q). */
float further_light()
{
    float arriving = 0.0;
    float leaving = 0.0;
    for (int k = 0; k < (further_bounces == 1 ? points_count : 0); k++) {
        arriving += points[k].arriving;
        leaving += points[k].flux.r + points[k].flux.g + points[k].flux.b;
    }
    return arriving > 0.0 ? 1.0 / (1.0 - min(leaving / arriving, 0.9)) : 1.0;
}

void main()
{
    int slot = invocation().x;
    if (slot >= shading_count)
        return;
    int class_points = shading_count / class_count;
    int wanted = class_member(slot / class_points, slot % class_points);
    int k = min(wanted, points_count - 1);
    Eye eye = Eye(vec3(0.0), 0, vec3(0.0), 0.0, vec3(0.0), 0.0, vec3(0.0), vec3(0.0));
    int e = 0;
    if (mapped == 1) {
        e = max(nearest[k], 0);
        eye = eyes[e];
    }
    vec3 off = points[k].position - eye.position;
    shading[slot].position = points[k].position;
    shading[slot].disk = softness * points[k].area / PI;
    shading[slot].normal = points[k].normal;
    shading[slot].near_square = visibility_near * visibility_near * dot(off, off);
    shading[slot].flux = wanted < points_count ? points[k].flux * further_light() : vec3(0.0);
    shading[slot].layer = e;
    shading[slot].eye = eye.position;
    shading[slot].tangent = eye.tangent;
    shading[slot].bitangent = eye.bitangent;
    shading[slot].axis = eye.normal;
}
