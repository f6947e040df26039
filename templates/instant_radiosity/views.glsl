/* Each VPL's map covers the hemisphere over its surface. */
#include "../shared/space.glsl"

void main()
{
    int k = invocation().x;
    if (k >= first_vpls)
        return;
    vec3 axis = unit_or(vpls[k].normal, vec3(0.0, 0.0, 1.0));
    vec3 eye = vpls[k].position + axis * (lift * frame.scene_radius);
    vec3 tangent, bitangent;
    tangent_frame(axis, tangent, bitangent);
    views[k].position = eye;
    views[k].member = vpls[k].flux.r + vpls[k].flux.g + vpls[k].flux.b > 0.0 ? k : -1;
    views[k].tangent = tangent;
    views[k].bitangent = bitangent;
    views[k].normal = axis;
    lights[k].position = vpls[k].position;
    lights[k].layer = k;
    lights[k].normal = vpls[k].normal;
    lights[k].disk = softness * vpls[k].area / PI;
    lights[k].flux = vpls[k].flux;
    lights[k].eye = eye;
    lights[k].tangent = tangent;
    lights[k].bitangent = bitangent;
    lights[k].axis = axis;
    draws[k].index_count = 3u * frame.triangle_count;
    draws[k].instance_count = 4u;
    draws[k].first_index = 0u;
    draws[k].vertex_offset = 0;
    draws[k].first_instance = uint(5 * k + 1); /* map_triangles.glsl */
}
