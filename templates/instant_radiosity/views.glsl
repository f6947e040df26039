/* Each VPL looks into the hemisphere over its own surface. */
#include "../shared/space.glsl"

void main()
{
    int k = invocation().x;
    if (k >= first_vpls)
        return;
    Vpl vpl = vpls[k];
    vec3 axis = unit_or(vpl.normal, vec3(0.0, 0.0, 1.0));
    vec3 eye = vpl.position + axis * (lift * frame.scene_radius);
    vec3 tangent, bitangent;
    tangent_frame(axis, tangent, bitangent);
    views[k].position = eye;
    views[k].member = vpl.flux.r + vpl.flux.g + vpl.flux.b > 0.0 ? k : -1;
    views[k].tangent = tangent;
    views[k].bitangent = bitangent;
    views[k].normal = axis;
    lights[k].position = vpl.position;
    lights[k].layer = k;
    lights[k].normal = vpl.normal;
    lights[k].disk = softness * vpl.area / PI;
    lights[k].flux = vpl.flux;
    lights[k].eye = eye;
    lights[k].tangent = tangent;
    lights[k].bitangent = bitangent;
    lights[k].axis = axis;
}
