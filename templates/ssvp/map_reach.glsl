/* Distances from the eye of a map, `reach`, of the numbers of the triangles. Only corners were
 * projected, so triangles are still bent. Therefore each texel's direction is intersected with the
 * plane of its triangle: where neighbours share a plane, the distance is that of an exact map, however
 * coarse the triangles. */
#include "../shared/space.glsl"
#include "../shared/triangle.glsl"
#include "texel.glsl"

/* Along the unit vector d; corners relative to the eye. */
float reach_along(vec3 d, vec3 a, vec3 b, vec3 c)
{
    vec3 right, up;
    tangent_frame(d, right, up);
    vec3 areas = ray_areas(vec3(dot(a, right), dot(b, right), dot(c, right)),
                           vec3(dot(a, up), dot(b, up), dot(c, up)));
    float sum = areas.x + areas.y + areas.z;
    vec3 weights = areas * (sum == 0.0 ? 0.0 : 1.0 / sum);
    float cut = dot(weights, vec3(dot(a, d), dot(b, d), dot(c, d)));
    weights = within_triangle(weights);
    float nearby = length(a * weights.x + b * weights.y + c * weights.z);
    /* False if the texel's ray runs along the plane or misses it. */
    bool sound = cut > 0.5 * nearby && cut < 2.0 * nearby;
    return sound ? cut : nearby;
}

void main()
{
    ivec3 at = invocation();
    if (any(greaterThanEqual(at.xy, reach_size())))
        return;
    uint triangle = number(at).x;
    if (triangle == 0u) {
        reach_store(at, vec4(1e30));
        return;
    }
    Triangle t = triangle_of(triangle - 1u);
    vec3 eye = views[at.z].position;
    vec3 local = texel_direction(vec2(at.xy) + 0.5);
    vec3 d = views[at.z].tangent * local.x + views[at.z].bitangent * local.y +
             views[at.z].normal * local.z;
    reach_store(at, vec4(reach_along(d, corner_position(t.a) - eye, corner_position(t.b) - eye,
                                     corner_position(t.c) - eye)));
}
